"""The tables of the learner's store, as they are in force; `revisions/` says how they came to be.

Five tables hold what arrived, append-only and in order of arrival: `body` is the message as it
travelled, the columns beside it are those that are asked for. There are no foreign keys between
them, because they come from different outboxes and may overtake one another.
"""

from sqlalchemy import (
    JSON,
    BigInteger,
    Boolean,
    Column,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    String,
    Table,
    Text,
)

# SQLite counts up by itself only where the type is spelled INTEGER.
COUNTER = BigInteger().with_variant(Integer(), "sqlite")
ID = String(64)

METADATA = MetaData(
    naming_convention={
        "ix": "ix_%(table_name)s_%(column_0_N_name)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
        "fk": "fk_%(table_name)s_%(column_0_N_name)s",
        "pk": "pk_%(table_name)s",
    }
)

DECISIONS = Table(
    "decisions",
    METADATA,
    Column("sequence", COUNTER, primary_key=True, autoincrement=True),
    Column("id", ID, nullable=False, unique=True),
    Column("robot", ID, nullable=False),
    Column("episode", ID, nullable=False, index=True),
    Column("step", Integer, nullable=False),
    Column("executed", Text, nullable=False),
    Column("best", Text, nullable=False),
    Column("chosen_by", Text, nullable=False),
    Column("version", String(32), nullable=False),
    Column("body", LargeBinary, nullable=False),
    Column("arrived_ns", BigInteger, nullable=False),
    Column("time_ns", BigInteger, nullable=True),
    sqlite_autoincrement=True,
)

CORRECTIONS = Table(
    "corrections",
    METADATA,
    Column("sequence", COUNTER, primary_key=True, autoincrement=True),
    Column("id", ID, nullable=False, unique=True),
    Column("robot", ID, nullable=False),
    Column("episode", ID, nullable=False, index=True),
    Column("kind", String(16), nullable=False),
    Column("author", ID, nullable=False),
    Column("body", LargeBinary, nullable=False),
    Column("arrived_ns", BigInteger, nullable=False),
    sqlite_autoincrement=True,
)

RECEIPTS = Table(
    "receipts",
    METADATA,
    Column("sequence", COUNTER, primary_key=True, autoincrement=True),
    Column("id", ID, nullable=False, unique=True),
    Column("robot", ID, nullable=False),
    Column("episode", ID, nullable=False, index=True),
    Column("accepted", Boolean, nullable=False),
    Column("body", LargeBinary, nullable=False),
    Column("arrived_ns", BigInteger, nullable=False),
    sqlite_autoincrement=True,
)

EPISODES = Table(
    "episodes",
    METADATA,
    Column("sequence", COUNTER, primary_key=True, autoincrement=True),
    Column("id", ID, nullable=False, unique=True),
    Column("robot", ID, nullable=False),
    Column("task", ID, nullable=False),
    Column("version", String(32), nullable=False),
    Column("outcome", String(16), nullable=False),
    Column("seed", BigInteger, nullable=False),
    Column("decisions", Integer, nullable=False),
    Column("corrections", Integer, nullable=False),
    Column("body", LargeBinary, nullable=False),
    Column("arrived_ns", BigInteger, nullable=False),
    sqlite_autoincrement=True,
)

RULINGS = Table(
    "rulings",
    METADATA,
    Column("sequence", COUNTER, primary_key=True, autoincrement=True),
    Column("id", ID, nullable=False, unique=True),
    Column("verb", String(16), nullable=False),
    Column("author", ID, nullable=False),
    Column("body", LargeBinary, nullable=False),
    Column("arrived_ns", BigInteger, nullable=False),
    Column("answered_ns", BigInteger, nullable=True),
    Column("made", Integer, ForeignKey("versions.number"), nullable=True),
    Column("reason", Text, nullable=False, server_default=""),
    sqlite_autoincrement=True,
)

TRIALS = Table(
    "trials",
    METADATA,
    Column("policy", String(64), primary_key=True),
    Column("plan", String(64), primary_key=True),
    Column("seed", BigInteger, primary_key=True, autoincrement=False),
    Column("success", Boolean, nullable=False),
    Column("row", JSON, nullable=False),
)

EPOCHS = Table(
    "epochs",
    METADATA,
    Column("number", Integer, primary_key=True, autoincrement=False),
    Column("learner", ID, nullable=False),
    Column("taken_ns", BigInteger, nullable=False),
)

VERSIONS = Table(
    "versions",
    METADATA,
    Column("number", Integer, primary_key=True, autoincrement=False),
    Column("epoch", Integer, ForeignKey("epochs.number"), nullable=False),
    Column("tensors", JSON, nullable=False),
    Column("bank", JSON, nullable=False),
    Column("settings", JSON, nullable=False),
    Column("low_level_sha256", String(64), nullable=False),
    Column("marks", JSON, nullable=False),
    Column("created_ns", BigInteger, nullable=False),
    Column("robots", JSON, nullable=False, server_default="[]"),
    Column("again", Integer, nullable=True),
    Column("ruling", ID, nullable=False, server_default=""),
)

ROUNDS = Table(
    "rounds",
    METADATA,
    Column("number", Integer, primary_key=True, autoincrement=False),
    Column("epoch", Integer, ForeignKey("epochs.number"), nullable=False),
    Column("parent", Integer, ForeignKey("versions.number"), nullable=False),
    Column("made", Integer, ForeignKey("versions.number"), nullable=True),
    Column("state", String(16), nullable=False),
    Column("seed", BigInteger, nullable=False),
    Column("manifest", JSON, nullable=False),
    Column("figures", JSON, nullable=False),
    Column("reason", Text, nullable=False),
    Column("begun_ns", BigInteger, nullable=False),
    Column("ended_ns", BigInteger, nullable=True),
    Column("candidate", JSON(none_as_null=True), nullable=True),
    Index("ix_rounds_state", "state"),
)
