"""Measured reports that come with the service; the README of the project has the same figures."""
