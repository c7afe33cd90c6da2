"""What the learner told of corrections: the version that learned each, or that it was held out."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make the table."""
    op.create_table(
        "learned",
        sa.Column("correction", sa.String(64), primary_key=True),
        sa.Column("version", sa.String(24)),
    )


def downgrade() -> None:
    """Take it away; the learner tells it again."""
    op.drop_table("learned")
