"""Create submissions, results and artefacts."""

import sqlalchemy as sa
from alembic import op
from sqlalchemy.dialects.postgresql import JSONB

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Create the first three tables."""
    op.create_table(
        "submission",
        sa.Column("id", sa.Uuid, primary_key=True),
        sa.Column("assignment", sa.Text, nullable=False),
        sa.Column("source", sa.Text, nullable=False),
        sa.Column("filename", sa.Text, nullable=False),
        sa.Column("exercises", sa.JSON, nullable=True),
        sa.Column("seed", sa.BigInteger, nullable=False),
        sa.Column("fingerprint", sa.Text, nullable=False),
        sa.Column("idempotency_key", sa.Text, nullable=True, unique=True),
        sa.Column("submitted_at", sa.DateTime(timezone=True), nullable=False, server_default=sa.func.now()),
    )
    op.create_table(
        "result",
        sa.Column("submission_id", sa.Uuid, sa.ForeignKey("submission.id"), primary_key=True),
        sa.Column("report", JSONB, nullable=True),
        sa.Column("fault", sa.Text, nullable=True),
        sa.Column("finished_at", sa.DateTime(timezone=True), nullable=False, server_default=sa.func.now()),
    )
    op.create_table(
        "artefact",
        sa.Column("submission_id", sa.Uuid, sa.ForeignKey("submission.id"), primary_key=True),
        sa.Column("name", sa.Text, primary_key=True),
        sa.Column("sha256", sa.Text, nullable=False),
        sa.Column("content", sa.LargeBinary, nullable=False),
    )
    # PNG and float64 arrays do not compress: keep them out of line and untouched (PostgreSQL, "TOAST
    # storage").
    op.execute("ALTER TABLE artefact ALTER COLUMN content SET STORAGE EXTERNAL")
