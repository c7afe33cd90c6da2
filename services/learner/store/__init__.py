"""What the learner keeps: what happened, what was made of it, and who may write."""
