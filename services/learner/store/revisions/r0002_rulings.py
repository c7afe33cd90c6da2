"""Rulings, trials of the gate, candidates and versions on trial; when a decision was taken."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None

COUNTER = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
ID = sa.String(64)


def upgrade() -> None:
    """Add tables and columns; nothing that is kept is touched."""
    op.add_column("decisions", sa.Column("time_ns", sa.BigInteger, nullable=True))
    op.add_column("versions", sa.Column("robots", sa.JSON, nullable=False, server_default="[]"))
    op.add_column("versions", sa.Column("again", sa.Integer, nullable=True))
    op.add_column("versions", sa.Column("ruling", ID, nullable=False, server_default=""))
    op.add_column("rounds", sa.Column("candidate", sa.JSON(none_as_null=True), nullable=True))
    op.create_table(
        "rulings",
        sa.Column("sequence", COUNTER, autoincrement=True, nullable=False),
        sa.Column("id", ID, nullable=False),
        sa.Column("verb", sa.String(16), nullable=False),
        sa.Column("author", ID, nullable=False),
        sa.Column("body", sa.LargeBinary, nullable=False),
        sa.Column("arrived_ns", sa.BigInteger, nullable=False),
        sa.Column("answered_ns", sa.BigInteger, nullable=True),
        sa.Column("made", sa.Integer, nullable=True),
        sa.Column("reason", sa.Text, nullable=False, server_default=""),
        sa.PrimaryKeyConstraint("sequence", name="pk_rulings"),
        sa.UniqueConstraint("id", name="uq_rulings_id"),
        sa.ForeignKeyConstraint(["made"], ["versions.number"], name="fk_rulings_made"),
        sqlite_autoincrement=True,
    )
    op.create_table(
        "trials",
        sa.Column("policy", sa.String(64), nullable=False),
        sa.Column("plan", sa.String(64), nullable=False),
        sa.Column("seed", sa.BigInteger, autoincrement=False, nullable=False),
        sa.Column("success", sa.Boolean, nullable=False),
        sa.Column("row", sa.JSON, nullable=False),
        sa.PrimaryKeyConstraint("policy", "plan", "seed", name="pk_trials"),
    )
