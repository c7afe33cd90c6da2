"""Alembic's folder: how one shape of the log becomes the next."""
