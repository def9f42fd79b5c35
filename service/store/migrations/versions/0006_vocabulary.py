"""Rename tables, columns, constraints and indexes to the vocabulary of the design; the data stay."""

from alembic import op

revision = "0006"
down_revision = "0005"

TABLES = {
    "attempt": "grading",
    "kept": "grading_artefact",
    "login": "device_login",
    "sign_in": "oidc_account",
}

COLUMNS = {
    "assignment": {"most_submissions": "submission_limit"},
    "audit": {"who": "actor"},
    "grading": {"most_runs": "max_runs", "held": "preview"},
    "grading_artefact": {"attempt_id": "grading_id"},
    "outcome": {"attempt_id": "grading_id"},
    "regrade": {"told": "description", "asked_by": "requested_by", "asked_at": "requested_at"},
    "result": {"attempt_id": "grading_id", "walls": "isolation"},
    "run": {"attempt_id": "grading_id", "beat_at": "heartbeat_at", "ending": "end_reason"},
    "token": {"start": "prefix"},
    "worker": {"walls": "isolation", "refusal": "unavailable_reason", "zygotes": "zygote_restarts"},
}

# PostgreSQL derives the names of constraints and indexes from tables and columns, and keeps them when these
# are renamed. Which ones exist depends on its version (NOT NULL is a named constraint since 18), so they are
# looked up.
RENAME_DERIVED = r"""
DO $$
DECLARE
    words CONSTANT text[] := ARRAY[{words}];
    old record;
    new_name text;
BEGIN
    FOR old IN
        SELECT conname AS name, conrelid::regclass AS relation, true AS is_constraint FROM pg_constraint
        WHERE conrelid = ANY(ARRAY[{relations}]::regclass[])
        UNION ALL
        SELECT index.relname, index.oid::regclass, false FROM pg_index JOIN pg_class index ON index.oid = indexrelid
        WHERE indrelid = ANY(ARRAY[{relations}]::regclass[])
            AND NOT EXISTS (SELECT FROM pg_constraint WHERE conindid = index.oid AND conname = index.relname)
    LOOP
        new_name := old.name;
        FOR k IN 1 .. array_length(words, 1) LOOP
            new_name := regexp_replace(new_name, '(^|_)' || words[k][1] || '(?=_|$)', '\1' || words[k][2], 'g');
        END LOOP;
        IF new_name <> old.name AND old.is_constraint THEN
            EXECUTE format('ALTER TABLE %s RENAME CONSTRAINT %I TO %I', old.relation, old.name, new_name);
        ELSIF new_name <> old.name THEN
            EXECUTE format('ALTER INDEX %s RENAME TO %I', old.relation, new_name);
        END IF;
    END LOOP;
END $$
"""


def upgrade() -> None:
    """Rename; jobs that are queued keep their argument ``attempt``, which the worker reads."""
    for old, new in TABLES.items():
        op.rename_table(old, new)
    for table, columns in COLUMNS.items():
        for old, new in columns.items():
            op.alter_column(table, old, new_column_name=new)
    op.execute("ALTER INDEX job_of_attempt RENAME TO job_of_grading")
    renamed = [*TABLES.items(), *(pair for columns in COLUMNS.values() for pair in columns.items())]
    words = ", ".join(f"ARRAY['{old}', '{new}']" for old, new in dict(renamed).items())
    relations = ", ".join(f"'{table}'" for table in sorted({*TABLES.values(), *COLUMNS}))
    # Past SQLAlchemy and the driver's parameters, for the colons and percent signs.
    op.get_bind().connection.driver_connection.execute(  # type: ignore[union-attr]
        RENAME_DERIVED.replace("{words}", words).replace("{relations}", relations)
    )
