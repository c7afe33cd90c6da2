"""What the correction API keeps on disk: what was said, what became of it, what is to be sent."""
