"""The actor: robots on the bus. Observe, decide, act, obey, record, refresh."""
