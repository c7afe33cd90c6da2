"""What is looked for afterwards: tasks of episodes, calls for help, rulings about versions."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Add them; the task of an episode that is there already is read from its message."""
    op.add_column("episodes", sa.Column("task", sa.String(64), nullable=False, server_default=""))
    op.execute("UPDATE episodes SET task = json_extract(message, '$.task')")
    op.create_index("ix_episodes_task", "episodes", ["task"])
    op.create_table(
        "calls",
        sa.Column("decision", sa.String(64), primary_key=True),
        sa.Column("episode", sa.String(64), nullable=False, index=True),
        sa.Column("message", sa.Text, nullable=False),
    )
    op.create_table(
        "rulings",
        sa.Column("sequence", sa.Integer, primary_key=True, autoincrement=True),
        sa.Column("id", sa.String(64), nullable=False, unique=True),
        sa.Column("message", sa.Text, nullable=False),
        sqlite_autoincrement=True,
    )


def downgrade() -> None:
    """Take them away, and what is in them."""
    op.drop_table("rulings")
    op.drop_table("calls")
    op.drop_index("ix_episodes_task", "episodes")
    op.drop_column("episodes", "task")
