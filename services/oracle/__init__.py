"""A scripted person: knows the true state, speaks over HTTP, errs and dawdles as people do."""
