"""Baselines: the hierarchy and three others, trained on equal data with equal means."""
