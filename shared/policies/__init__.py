"""The two levels: what they compute, how they are kept on disk, how the high one learns."""
