"""Reads a person's phrase as a command: the judges, and the rules around them."""
