"""Measures policies in the cell: episodes without people, single skills, single phrases."""
