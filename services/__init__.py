"""The processes. They never import one another: they speak by messages."""
