"""Speaking: a held key, a few words, and the command that was meant; recognised offline."""
