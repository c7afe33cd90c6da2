"""What starts the services: the router, the laptop supervisor, the `hld` command."""
