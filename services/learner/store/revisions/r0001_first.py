"""The first form of the store."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None

COUNTER = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
ID = sa.String(64)


def upgrade() -> None:
    """Make all tables."""
    _arrivals(
        "decisions",
        sa.Column("episode", ID, nullable=False),
        sa.Column("step", sa.Integer, nullable=False),
        sa.Column("executed", sa.Text, nullable=False),
        sa.Column("best", sa.Text, nullable=False),
        sa.Column("chosen_by", sa.Text, nullable=False),
        sa.Column("version", sa.String(32), nullable=False),
    )
    _arrivals(
        "corrections",
        sa.Column("episode", ID, nullable=False),
        sa.Column("kind", sa.String(16), nullable=False),
        sa.Column("author", ID, nullable=False),
    )
    _arrivals(
        "receipts",
        sa.Column("episode", ID, nullable=False),
        sa.Column("accepted", sa.Boolean, nullable=False),
    )
    _arrivals(
        "episodes",
        sa.Column("task", ID, nullable=False),
        sa.Column("version", sa.String(32), nullable=False),
        sa.Column("outcome", sa.String(16), nullable=False),
        sa.Column("seed", sa.BigInteger, nullable=False),
        sa.Column("decisions", sa.Integer, nullable=False),
        sa.Column("corrections", sa.Integer, nullable=False),
    )
    for table in ("decisions", "corrections", "receipts"):
        op.create_index(f"ix_{table}_episode", table, ["episode"])
    _made()


def _arrivals(name: str, *columns: sa.Column[object]) -> None:
    op.create_table(
        name,
        sa.Column("sequence", COUNTER, autoincrement=True, nullable=False),
        sa.Column("id", ID, nullable=False),
        sa.Column("robot", ID, nullable=False),
        *columns,
        sa.Column("body", sa.LargeBinary, nullable=False),
        sa.Column("arrived_ns", sa.BigInteger, nullable=False),
        sa.PrimaryKeyConstraint("sequence", name=f"pk_{name}"),
        sa.UniqueConstraint("id", name=f"uq_{name}_id"),
        sqlite_autoincrement=True,
    )


def _made() -> None:
    op.create_table(
        "epochs",
        sa.Column("number", sa.Integer, autoincrement=False, nullable=False),
        sa.Column("learner", ID, nullable=False),
        sa.Column("taken_ns", sa.BigInteger, nullable=False),
        sa.PrimaryKeyConstraint("number", name="pk_epochs"),
    )
    op.create_table(
        "versions",
        sa.Column("number", sa.Integer, autoincrement=False, nullable=False),
        sa.Column("epoch", sa.Integer, nullable=False),
        sa.Column("tensors", sa.JSON, nullable=False),
        sa.Column("bank", sa.JSON, nullable=False),
        sa.Column("settings", sa.JSON, nullable=False),
        sa.Column("low_level_sha256", sa.String(64), nullable=False),
        sa.Column("marks", sa.JSON, nullable=False),
        sa.Column("created_ns", sa.BigInteger, nullable=False),
        sa.PrimaryKeyConstraint("number", name="pk_versions"),
        sa.ForeignKeyConstraint(["epoch"], ["epochs.number"], name="fk_versions_epoch"),
    )
    op.create_table(
        "rounds",
        sa.Column("number", sa.Integer, autoincrement=False, nullable=False),
        sa.Column("epoch", sa.Integer, nullable=False),
        sa.Column("parent", sa.Integer, nullable=False),
        sa.Column("made", sa.Integer, nullable=True),
        sa.Column("state", sa.String(16), nullable=False),
        sa.Column("seed", sa.BigInteger, nullable=False),
        sa.Column("manifest", sa.JSON, nullable=False),
        sa.Column("figures", sa.JSON, nullable=False),
        sa.Column("reason", sa.Text, nullable=False),
        sa.Column("begun_ns", sa.BigInteger, nullable=False),
        sa.Column("ended_ns", sa.BigInteger, nullable=True),
        sa.PrimaryKeyConstraint("number", name="pk_rounds"),
        sa.ForeignKeyConstraint(["epoch"], ["epochs.number"], name="fk_rounds_epoch"),
        sa.ForeignKeyConstraint(["parent"], ["versions.number"], name="fk_rounds_parent"),
        sa.ForeignKeyConstraint(["made"], ["versions.number"], name="fk_rounds_made"),
    )
    op.create_index("ix_rounds_state", "rounds", ["state"])
