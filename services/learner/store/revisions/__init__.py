"""How the store came to its form of today, step by step; Alembic runs them by name."""
