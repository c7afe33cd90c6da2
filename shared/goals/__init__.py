"""What a goal is and does: one folder a family, the same files in each."""
