"""Figures for Prometheus; one registry per service, nothing global."""

from collections.abc import Callable

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, generate_latest

LATENCY_BUCKETS_S = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 30.0, 120.0)


class Metrics:
    """What the correction API counts.

    corrections: accepted, by kind. closed: by what became of them.
    latency: from the acceptance of a correction to its receipt.
    unreadable: messages from the bus that were none.
    help_asked: calls for help, by reason; help_answered: of those that were shown;
        help_expired: nobody came in the time that a robot stood still;
        help_suppressed: beyond the budget of the fleet, and not shown.
    live_dropped: what slow pages did not get, by the kind of what was lost.
    """

    def __init__(self) -> None:
        self.registry = registry = CollectorRegistry()
        self.corrections = Counter(
            "hldagger_corrections", "Corrections accepted", ["kind"], registry=registry
        )
        self.closed = Counter(
            "hldagger_corrections_closed", "Corrections closed", ["status"], registry=registry
        )
        self.latency = Histogram(
            "hldagger_correction_latency_seconds",
            "From the acceptance of a correction to its receipt",
            buckets=LATENCY_BUCKETS_S,
            registry=registry,
        )
        self.unreadable = Counter(
            "hldagger_messages_unreadable", "Messages that were none", registry=registry
        )
        self.live_dropped = Counter(
            "hldagger_live_dropped", "What slow pages did not get", ["kind"], registry=registry
        )
        self.help_asked = Counter(
            "hldagger_help_asked", "Calls for help", ["reason"], registry=registry
        )
        self.help_answered = Counter(
            "hldagger_help_answered", "Calls for help that somebody answered", registry=registry
        )
        self.help_expired = Counter(
            "hldagger_help_expired", "Robots that waited for nobody", registry=registry
        )
        self.help_suppressed = Counter(
            "hldagger_help_suppressed", "Calls beyond the fleet's budget", registry=registry
        )
        self.frames = Counter("hldagger_frames", "Camera pictures taken in", registry=registry)

    def gauge(self, name: str, text: str, read: Callable[[], float]) -> None:
        """A figure that is read when somebody asks for it."""
        Gauge(f"hldagger_{name}", text, registry=self.registry).set_function(read)

    def render(self) -> bytes:
        """All of it in Prometheus' text format."""
        return generate_latest(self.registry)
