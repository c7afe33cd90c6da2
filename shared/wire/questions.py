"""Asking and answering over Zenoh: what is an answer, what a refusal, what is neither."""

import threading
from collections.abc import Callable

import structlog
import zenoh
from zenoh.handlers import Callback

from shared.errors import HldError, MessageError, NoAnswerError, RefusedError
from shared.wire.bus import INTERNAL_ERROR, Answer, Urgency, check_payload
from shared.wire.codec import MAX_BYTES
from shared.wire.worker import Worker

# Zenoh tells a time-out as an error reply, too; a refusal is known by its encoding.
REFUSAL = zenoh.Encoding.TEXT_PLAIN.with_schema("refusal")
MAX_REASON = 2000  # characters

PRIORITY = {
    Urgency.REAL_TIME: zenoh.Priority.REAL_TIME,
    Urgency.NORMAL: zenoh.Priority.DATA,
    Urgency.BACKGROUND: zenoh.Priority.BACKGROUND,
}


def ask(
    session: zenoh.Session, key: str, payload: bytes, timeout_s: float, urgency: Urgency
) -> bytes:
    """The first answer; as `Bus.ask`."""
    answers = _Answers()
    try:
        session.get(
            key,
            Callback(answers.take, answers.end, indirect=False),
            target=zenoh.QueryTarget.ALL,
            # Anything else holds the first answer back until the last one came.
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=timeout_s,
            congestion_control=zenoh.CongestionControl.BLOCK,
            priority=PRIORITY[urgency],
            express=urgency is Urgency.REAL_TIME,
            payload=payload,
        )
    except zenoh.ZError as error:
        raise NoAnswerError(f"{key}: {error}") from None
    return answers.wait(key, timeout_s)


def answer(query: zenoh.Query, handler: Answer) -> None:
    """Reply to a question by `handler`; as `Bus.serve`."""
    key = str(query.key_expr)
    try:
        reply = handler(key, payload_of(query))
        check_payload(key, reply)
    except HldError as error:
        query.reply_err(str(error)[:MAX_REASON].encode(), encoding=REFUSAL)
    except Exception:
        structlog.get_logger().exception("a handler failed", key=key)
        query.reply_err(INTERNAL_ERROR.encode(), encoding=REFUSAL)
    else:
        query.reply(key, reply)


def is_message(sample: zenoh.Sample) -> bool:
    """Whether it can be one: a put (nobody of ours deletes), and not too large to be copied."""
    return sample.kind == zenoh.SampleKind.PUT and len(sample.payload) <= MAX_BYTES


def payload_of(query: zenoh.Query) -> bytes:
    """What came with a question.

    Raises:
        MessageError: too much to be copied.
    """
    if query.payload is None:
        return b""
    if len(query.payload) > MAX_BYTES:
        raise MessageError(f"{len(query.payload)} bytes are too many: at most {MAX_BYTES}")
    return query.payload.to_bytes()


def offer_to(worker: Worker[zenoh.Query]) -> Callable[[zenoh.Query], None]:
    """Queues questions at the worker; what finds it full ends without an answer, at once, so
    that it is asked again."""

    def offer(query: zenoh.Query) -> None:
        if not worker.offer(query):
            with query:
                pass  # Leaving the block tells the other side that nothing will come.

    return offer


class _Answers:
    """What came back for one question: the first answer ends it, refusals wait for the rest."""

    def __init__(self) -> None:
        self._done = threading.Event()
        self._answer: bytes | None = None
        self._refusal: str | None = None

    def take(self, reply: zenoh.Reply) -> None:
        if reply.ok is not None:
            if self._answer is None and is_message(reply.ok):
                self._answer = reply.ok.payload.to_bytes()
                self._done.set()
        elif reply.err is not None and reply.err.encoding == REFUSAL:
            self._refusal = reply.err.payload.to_bytes().decode(errors="replace")

    def end(self) -> None:
        self._done.set()

    def wait(self, key: str, timeout_s: float) -> bytes:
        self._done.wait(timeout_s)
        if self._answer is not None:
            return self._answer
        if self._refusal is not None:
            raise RefusedError(self._refusal)
        raise NoAnswerError(f"{key}: nobody answered within {timeout_s:g} s")
