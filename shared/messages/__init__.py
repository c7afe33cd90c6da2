"""What travels between the services. Each file is a noun; see the README for the table."""
