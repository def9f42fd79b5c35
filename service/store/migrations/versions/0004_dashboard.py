"""Create the dashboard's tables: outcomes by check, overrides, extensions, previewed regrades, details of
people, signing key.
"""

from alembic import op

revision = "0004"
down_revision = "0003"

NEEDED = """
ALTER TABLE person ADD full_name text NOT NULL DEFAULT '', ADD email text NOT NULL DEFAULT '',
    ADD student_id text NOT NULL DEFAULT '', ADD password text;
CREATE TABLE secret (name text PRIMARY KEY, value text NOT NULL);
INSERT INTO secret VALUES ('forms', gen_random_uuid()::text || gen_random_uuid()::text);
CREATE TABLE extension (
    assignment_id uuid NOT NULL REFERENCES assignment, person_id uuid NOT NULL REFERENCES person, due_at timestamptz NOT NULL,
    reason text NOT NULL, given_by text NOT NULL, given_at timestamptz NOT NULL DEFAULT now(),
    PRIMARY KEY (assignment_id, person_id)
);
CREATE TABLE regrade (
    id uuid PRIMARY KEY DEFAULT gen_random_uuid(), assignment_id uuid NOT NULL REFERENCES assignment, told text NOT NULL,
    asked_by text NOT NULL, asked_at timestamptz NOT NULL DEFAULT now(), decided text, decided_by text, decided_at timestamptz
);
ALTER TABLE attempt ADD regrade_id uuid REFERENCES regrade, ADD held boolean NOT NULL DEFAULT false;
CREATE INDEX attempt_regrade ON attempt (regrade_id) WHERE regrade_id IS NOT NULL;
CREATE TABLE override (
    id uuid PRIMARY KEY DEFAULT gen_random_uuid(), submission_id uuid NOT NULL REFERENCES submission, check_id text,
    points integer NOT NULL CHECK (points >= 0), reason text NOT NULL, given_by text NOT NULL,
    given_at timestamptz NOT NULL DEFAULT now(), withdrawn_by text, withdrawn_at timestamptz
);
CREATE UNIQUE INDEX override_in_force ON override (submission_id, coalesce(check_id, '')) WHERE withdrawn_at IS NULL;
CREATE TABLE outcome (
    attempt_id uuid NOT NULL REFERENCES attempt, check_id text NOT NULL, state text NOT NULL, counted boolean NOT NULL,
    margin double precision, codes text[] NOT NULL, causes text[] NOT NULL, PRIMARY KEY (attempt_id, check_id)
);
ALTER TABLE run ADD scene_at timestamptz NOT NULL DEFAULT now();
ALTER TABLE result ADD cancelled_by text;
"""

# The same rows as service.store.runs writes for a new report.
KNOWN = """
INSERT INTO outcome (attempt_id, check_id, state, counted, margin, codes, causes)
SELECT r.attempt_id, o->>'id',
    CASE WHEN o->>'verdict' <> 'unmeasured' THEN o->>'verdict' WHEN how.ending = 'timed-out' THEN 'timeout'
        WHEN coalesce(how.ending, 'not-played') IN ('not-played', 'missing-function', 'finished') THEN 'unmeasured'
        ELSE 'error' END,
    coalesce((o->>'counted')::boolean, true), (o->>'margin')::double precision,
    ARRAY(SELECT d->>'code' FROM jsonb_array_elements(coalesce(o->'diagnosis', '[]')) d),
    ARRAY(SELECT d->>'sentence' FROM jsonb_array_elements(coalesce(o->'diagnosis', '[]')) d)
FROM result r, jsonb_array_elements(r.report->'exercises') e, jsonb_array_elements(e->'outcomes') o
    LEFT JOIN LATERAL (SELECT f->>'ending' AS ending FROM jsonb_array_elements(coalesce(r.report->'endings', '[]')) f
        WHERE f->>'sentence' = o->>'cause' LIMIT 1) how ON true
WHERE r.report IS NOT NULL
ON CONFLICT DO NOTHING
"""


def upgrade() -> None:
    op.get_bind().connection.driver_connection.execute(NEEDED)  # type: ignore[union-attr]
    op.execute(KNOWN)
