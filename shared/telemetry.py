"""Logs as lines of JSON for machines, or coloured for people when a terminal is watching."""

import logging
import sys

import structlog


def set_up(service: str, level: str = "info") -> structlog.stdlib.BoundLogger:
    """Make this process log to standard error; `service` is on every line.

    Level names: debug, info, warning, error.
    """
    people = sys.stderr.isatty()
    render = structlog.dev.ConsoleRenderer() if people else structlog.processors.JSONRenderer()
    structlog.configure(
        processors=[
            structlog.contextvars.merge_contextvars,
            structlog.processors.add_log_level,
            structlog.processors.TimeStamper(fmt="iso"),
            structlog.processors.format_exc_info,
            render,
        ],
        wrapper_class=structlog.make_filtering_bound_logger(getattr(logging, level.upper())),
        logger_factory=structlog.PrintLoggerFactory(sys.stderr),
        cache_logger_on_first_use=True,
    )
    logger: structlog.stdlib.BoundLogger = structlog.get_logger(service=service)
    return logger
