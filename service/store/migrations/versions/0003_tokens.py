"""Create tokens and pending device logins."""

from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """Create the tables."""
    op.execute("""
    CREATE TABLE token (
        id uuid PRIMARY KEY DEFAULT gen_random_uuid(), person_id uuid NOT NULL REFERENCES person, digest text NOT NULL UNIQUE,
        start text NOT NULL, label text NOT NULL, scopes text[] NOT NULL, created_at timestamptz NOT NULL DEFAULT now(),
        expires_at timestamptz NOT NULL, used_at timestamptz, revoked_at timestamptz
    )""")
    op.execute("CREATE INDEX token_person ON token (person_id)")
    op.execute("""
    CREATE TABLE login (
        device_digest text PRIMARY KEY, user_code text NOT NULL UNIQUE, label text NOT NULL,
        created_at timestamptz NOT NULL DEFAULT now(), expires_at timestamptz NOT NULL, person_id uuid REFERENCES person,
        refused boolean NOT NULL DEFAULT false
    )""")
