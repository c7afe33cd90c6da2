"""Goals in words: sentences become vectors that lie near each other when they mean the same."""
