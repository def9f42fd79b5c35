"""Store the weight of each assignment in the course."""

from alembic import op

revision = "0008"
down_revision = "0007"


def upgrade() -> None:
    op.execute("ALTER TABLE assignment ADD weight double precision NOT NULL DEFAULT 1 CHECK (weight >= 0)")
