"""Create the links of people to accounts at an OpenID provider."""

from alembic import op

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    op.execute("""
    CREATE TABLE sign_in (
        issuer text NOT NULL, subject text NOT NULL, person_id uuid NOT NULL UNIQUE REFERENCES person,
        since timestamptz NOT NULL DEFAULT now(), PRIMARY KEY (issuer, subject)
    )
    """)
