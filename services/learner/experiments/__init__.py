"""Experiments: what the hierarchy can do, what limits it, and what it is compared with."""
