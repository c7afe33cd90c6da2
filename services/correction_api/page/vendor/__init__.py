"""Modules of others, as they came; see the README."""
