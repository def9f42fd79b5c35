"""Create courses, people, assignments, gradings and runs, shared artefacts, the audit log and Procrastinate's
tables.
"""

from alembic import op
from procrastinate.schema import SchemaManager

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    """Create the new tables and move the data into them; each submission gets its first grading."""
    for name in ("submission", "result", "artefact"):
        op.rename_table(name, f"old_{name}")
        op.execute(f"ALTER INDEX {name}_pkey RENAME TO old_{name}_pkey")
    connection = op.get_bind()
    # Through the driver, as SQLAlchemy would take percent signs for parameters.
    run = connection.connection.driver_connection.execute  # type: ignore[union-attr]
    run(_TABLES)
    run(_MOVED)
    op.execute("DROP TABLE old_artefact, old_result, old_submission")
    run(_UNALTERED)
    run(SchemaManager.get_schema())
    run("CREATE INDEX job_of_attempt ON procrastinate_jobs ((args->>'attempt'))")


_TABLES = """
CREATE TABLE course (id uuid PRIMARY KEY DEFAULT gen_random_uuid(), slug text NOT NULL UNIQUE, title text NOT NULL);
CREATE TABLE person (
    id uuid PRIMARY KEY DEFAULT gen_random_uuid(), name text NOT NULL UNIQUE, created_at timestamptz NOT NULL DEFAULT now()
);
CREATE TABLE member (
    course_id uuid REFERENCES course, person_id uuid REFERENCES person, role text NOT NULL, PRIMARY KEY (course_id, person_id)
);
CREATE TABLE assignment (
    id uuid PRIMARY KEY DEFAULT gen_random_uuid(), course_id uuid NOT NULL REFERENCES course, slug text NOT NULL,
    due_at timestamptz, grace_s double precision NOT NULL DEFAULT 0, most_submissions integer, UNIQUE (course_id, slug)
);
CREATE TABLE assignment_version (
    assignment_id uuid REFERENCES assignment, version text, since timestamptz NOT NULL DEFAULT now(),
    PRIMARY KEY (assignment_id, version)
);
CREATE TABLE submission (
    id uuid PRIMARY KEY, assignment_id uuid NOT NULL REFERENCES assignment, person_id uuid NOT NULL REFERENCES person,
    source text NOT NULL, sha256 text NOT NULL, filename text NOT NULL, exercises jsonb, late boolean NOT NULL DEFAULT false,
    fingerprint text NOT NULL, idempotency_key text, submitted_at timestamptz NOT NULL DEFAULT now(),
    UNIQUE (person_id, idempotency_key)
);
CREATE INDEX submission_person_assignment ON submission (person_id, assignment_id);
CREATE INDEX submission_submitted_at ON submission (submitted_at);
CREATE TABLE attempt (
    id uuid PRIMARY KEY, submission_id uuid NOT NULL REFERENCES submission, number integer NOT NULL, kind text NOT NULL,
    seed bigint NOT NULL, most_runs integer NOT NULL, requested_at timestamptz NOT NULL DEFAULT now(),
    UNIQUE (submission_id, number)
);
CREATE TABLE run (
    id uuid PRIMARY KEY, attempt_id uuid NOT NULL REFERENCES attempt, worker text NOT NULL,
    started_at timestamptz NOT NULL DEFAULT now(), beat_at timestamptz NOT NULL DEFAULT now(),
    phase text NOT NULL DEFAULT '', scene integer NOT NULL DEFAULT 0, scenes integer NOT NULL DEFAULT 0,
    ended_at timestamptz, ending text, note text
);
CREATE INDEX ix_run_attempt_id ON run (attempt_id);
CREATE INDEX run_open ON run (beat_at) WHERE ended_at IS NULL;
CREATE TABLE result (
    attempt_id uuid PRIMARY KEY REFERENCES attempt, run_id uuid REFERENCES run, report jsonb, fault text,
    score integer, max_score integer, version text, walls text, grading_s double precision,
    finished_at timestamptz NOT NULL DEFAULT now()
);
CREATE TABLE artefact (sha256 text PRIMARY KEY, content bytea NOT NULL);
-- PNG and float64 arrays do not compress: keep them out of line and untouched (PostgreSQL, "TOAST storage").
ALTER TABLE artefact ALTER COLUMN content SET STORAGE EXTERNAL;
CREATE TABLE kept (
    attempt_id uuid REFERENCES attempt, name text, sha256 text NOT NULL REFERENCES artefact, PRIMARY KEY (attempt_id, name)
);
CREATE TABLE worker (
    name text PRIMARY KEY, walls text, refusal text, zygotes integer NOT NULL DEFAULT 0,
    since timestamptz NOT NULL DEFAULT now(), seen_at timestamptz NOT NULL DEFAULT now()
);
CREATE TABLE audit (
    id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY, at timestamptz NOT NULL DEFAULT now(),
    who text NOT NULL, action text NOT NULL, subject text NOT NULL, detail jsonb NOT NULL DEFAULT '{}'
)
"""

_MOVED = """
INSERT INTO course (slug, title) VALUES ('local', 'This server');
INSERT INTO person (name) VALUES ('local');
INSERT INTO member SELECT course.id, person.id, 'student' FROM course, person;
INSERT INTO assignment (course_id, slug) SELECT course.id, found.assignment
    FROM course, (SELECT DISTINCT assignment FROM old_submission) AS found;
INSERT INTO submission
    (id, assignment_id, person_id, source, sha256, filename, exercises, fingerprint, idempotency_key, submitted_at)
    SELECT old.id, assignment.id, person.id, source, encode(sha256(convert_to(source, 'UTF8')), 'hex'), filename,
           CASE WHEN exercises::text = 'null' THEN NULL ELSE exercises::jsonb END, fingerprint, idempotency_key, submitted_at
    FROM old_submission AS old JOIN assignment ON assignment.slug = old.assignment, person;
INSERT INTO attempt (id, submission_id, number, kind, seed, most_runs, requested_at)
    SELECT gen_random_uuid(), id, 1, 'interactive', seed, 3, submitted_at FROM old_submission;
INSERT INTO result (attempt_id, report, fault, score, max_score, version, walls, finished_at)
    SELECT attempt.id, NULLIF(report, 'null'), fault, (report->>'score')::numeric::int, (report->>'max_score')::numeric::int,
           report->>'version',
           report->'provenance'->>'walls', finished_at
    FROM old_result AS old JOIN attempt ON attempt.submission_id = old.submission_id;
INSERT INTO artefact SELECT DISTINCT ON (sha256) sha256, content FROM old_artefact;
INSERT INTO kept SELECT attempt.id, old.name, old.sha256
    FROM old_artefact AS old JOIN attempt ON attempt.submission_id = old.submission_id
"""

_UNALTERED = """
CREATE FUNCTION refuse_to_alter() RETURNS trigger LANGUAGE plpgsql AS
    $$ BEGIN RAISE 'a % is never altered', TG_TABLE_NAME; END $$;
CREATE TRIGGER submission_is_never_altered BEFORE UPDATE ON submission FOR EACH ROW EXECUTE FUNCTION refuse_to_alter();
CREATE TRIGGER result_is_never_altered BEFORE UPDATE ON result FOR EACH ROW EXECUTE FUNCTION refuse_to_alter()
"""
