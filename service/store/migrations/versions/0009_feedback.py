"""Create the tables of regrade requests and of comments on source lines."""

from alembic import op

revision = "0009"
down_revision = "0008"

FEEDBACK = """
CREATE TABLE regrade_request (
    id uuid PRIMARY KEY DEFAULT gen_random_uuid(), submission_id uuid NOT NULL REFERENCES submission, reason text NOT NULL,
    requested_at timestamptz NOT NULL DEFAULT now(), status text NOT NULL DEFAULT 'open'
        CHECK (status IN ('open', 'accepted', 'declined')),
    answer text, answered_by text, answered_at timestamptz,
    CHECK ((status = 'open') = (answered_at IS NULL))
);
CREATE INDEX regrade_request_submission ON regrade_request (submission_id);
CREATE UNIQUE INDEX regrade_request_open ON regrade_request (submission_id) WHERE status = 'open';
CREATE TABLE source_comment (
    id uuid PRIMARY KEY DEFAULT gen_random_uuid(), submission_id uuid NOT NULL REFERENCES submission,
    cell integer NOT NULL CHECK (cell > 0), line integer NOT NULL CHECK (line > 0), comment text NOT NULL, author text NOT NULL,
    written_at timestamptz NOT NULL DEFAULT now()
);
CREATE INDEX source_comment_submission ON source_comment (submission_id);
"""


def upgrade() -> None:
    op.execute(FEEDBACK)
