"""The shapes of the log, from the first to the newest."""
