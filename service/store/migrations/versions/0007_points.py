"""Store what each check is worth and what it earned; a check of an older report is worth one point."""

from alembic import op

revision = "0007"
down_revision = "0006"

EARNED = "UPDATE outcome SET earned = 1 WHERE state = 'pass'"


def upgrade() -> None:
    op.execute(
        "ALTER TABLE outcome ADD points integer NOT NULL DEFAULT 1, ADD earned integer NOT NULL DEFAULT 0"
    )
    op.execute(EARNED)
    op.execute("ALTER TABLE outcome ALTER points DROP DEFAULT, ALTER earned DROP DEFAULT")
