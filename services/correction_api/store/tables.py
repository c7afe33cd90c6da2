"""The tables of the correction log; `sequence` is the order in which things were said."""

from sqlalchemy import BigInteger, Column, Integer, LargeBinary, MetaData, String, Table, Text

metadata = MetaData()

# message, receipt: heads as JSON. digest: sha256 of what the client sent, so that a repeated id
# with another body is noticed. status: a value of `history.Status`. reason: why it was refused.
corrections = Table(
    "corrections",
    metadata,
    Column("sequence", Integer, primary_key=True, autoincrement=True),
    Column("id", String(64), nullable=False, unique=True),
    Column("robot", String(64), nullable=False, index=True),
    Column("episode", String(64), nullable=False, index=True),
    Column("kind", String(16), nullable=False),
    Column("status", String(16), nullable=False, index=True),
    Column("digest", String(64), nullable=False),
    Column("created_ns", BigInteger, nullable=False),
    Column("message", Text, nullable=False),
    Column("receipt", Text),
    Column("reason", Text),
    sqlite_autoincrement=True,
)

# What the learner does not have yet, in order. refused: it said no, and this is why.
outbox = Table(
    "outbox",
    metadata,
    Column("sequence", Integer, primary_key=True, autoincrement=True),
    Column("id", String(80), nullable=False, unique=True),
    Column("key", Text, nullable=False),
    Column("payload", LargeBinary, nullable=False),
    Column("refused", Text, index=True),
    sqlite_autoincrement=True,
)

episodes = Table(
    "episodes",
    metadata,
    Column("sequence", Integer, primary_key=True, autoincrement=True),
    Column("id", String(64), nullable=False, unique=True),
    Column("robot", String(64), nullable=False, index=True),
    Column("version", String(24), nullable=False, index=True),
    Column("outcome", String(16), nullable=False),
    Column("corrections", Integer, nullable=False),
    Column("message", Text, nullable=False),
    Column("task", String(64), nullable=False, index=True, server_default=""),
    sqlite_autoincrement=True,
)

# Calls for help, each once, by the decision at which it began; message: the `Help`.
calls = Table(
    "calls",
    metadata,
    Column("decision", String(64), primary_key=True),
    Column("episode", String(64), nullable=False, index=True),
    Column("message", Text, nullable=False),
)

# What people decided about versions; what became of it is the learner's to say.
rulings = Table(
    "rulings",
    metadata,
    Column("sequence", Integer, primary_key=True, autoincrement=True),
    Column("id", String(64), nullable=False, unique=True),
    Column("message", Text, nullable=False),
    sqlite_autoincrement=True,
)

# What the learner told. version: the first that learned it; null: it is held out, to judge by.
learned = Table(
    "learned",
    metadata,
    Column("correction", String(64), primary_key=True),
    Column("version", String(24)),
)
