"""What two services must agree upon; what only one of them uses lives in that service."""
