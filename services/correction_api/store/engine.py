"""Opens the log: SQLite with a write-ahead log that is flushed to the disk at each commit."""

from pathlib import Path
from sqlite3 import Connection as SqliteConnection

from alembic import command
from alembic.config import Config
from sqlalchemy import Connection, Engine, create_engine, event
from sqlalchemy.pool import ConnectionPoolEntry

BUSY_TIMEOUT_S = 2.0
READERS = 8


def open_engine(database: Path, *, begin: str = "BEGIN", size: int = READERS) -> Engine:
    """An engine on `database`; `begin` says how its transactions start.

    FULL: a correction is acknowledged only after it is on the disk, also when the power fails.
    """
    engine = create_engine(
        f"sqlite:///{database}",
        pool_size=size,
        max_overflow=4 * size,
        connect_args={"timeout": BUSY_TIMEOUT_S, "check_same_thread": False},
    )

    @event.listens_for(engine, "connect")
    def configure(connection: SqliteConnection, entry: ConnectionPoolEntry) -> None:
        del entry  # Unused.
        connection.isolation_level = None  # The driver must not begin transactions by itself.
        connection.execute("PRAGMA journal_mode=WAL")
        connection.execute("PRAGMA synchronous=FULL")

    @event.listens_for(engine, "begin")
    def start(connection: Connection) -> None:
        connection.exec_driver_sql(begin)

    return engine


def upgrade(engine: Engine, shape: str = "head") -> None:
    """Bring the tables to a shape, the newest one; a new file gets all of them."""
    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations"))
    config.set_main_option("path_separator", "os")
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        command.upgrade(config, shape)
