"""Find the gradings that have a stored file by its contents, as foreign keys and ``polhode db prune`` do."""

from alembic import op

revision = "0011"
down_revision = "0010"


def upgrade() -> None:
    op.execute(
        "DROP INDEX IF EXISTS prune_artefacts"
    )  # of a killed `polhode db prune`, which formerly made its own
    op.execute("CREATE INDEX grading_artefact_sha256 ON grading_artefact (sha256)")
