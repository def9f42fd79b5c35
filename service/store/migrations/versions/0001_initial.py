"""Create all tables: course, people and accounts, submissions, gradings, feedback, workers, the queue."""

from alembic import op
from procrastinate.schema import SchemaManager

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Create the tables of an empty database, in the order of their references."""
    _create_course()
    _create_accounts()
    _create_submissions()
    _create_gradings()
    _create_feedback()
    _create_operation()
    _create_queue()
    _forbid_changes()
    _insert_first_rows()


def _create_course() -> None:
    op.execute("""
    CREATE TABLE course (
        id uuid PRIMARY KEY DEFAULT gen_random_uuid(),
        slug text NOT NULL UNIQUE,
        title text NOT NULL DEFAULT '',
        term text NOT NULL DEFAULT '',
        logins boolean NOT NULL DEFAULT false, -- people log in, also on a server without logins
        time_zone text NOT NULL DEFAULT 'UTC',
        -- Shares of the points, from 0 to 1: lost for each day begun, and lost at most.
        late_penalty double precision NOT NULL DEFAULT 0 CHECK (late_penalty BETWEEN 0 AND 1),
        late_penalty_limit double precision NOT NULL DEFAULT 1 CHECK (late_penalty_limit BETWEEN 0 AND 1)
    )""")
    op.execute("""
    CREATE TABLE person (
        id uuid PRIMARY KEY DEFAULT gen_random_uuid(),
        name text NOT NULL UNIQUE,
        created_at timestamptz NOT NULL DEFAULT now(),
        full_name text NOT NULL DEFAULT '',
        email text NOT NULL DEFAULT '',
        student_id text NOT NULL DEFAULT '',
        section text NOT NULL DEFAULT '',
        -- Folded surname and first name, which Python computes: PostgreSQL without ICU cannot fold accents.
        sort_key text COLLATE "C" NOT NULL DEFAULT '',
        password text -- an Argon2 hash; null: the person cannot log in with a password
    )""")
    op.execute("""
    CREATE TABLE member (
        course_id uuid REFERENCES course,
        person_id uuid REFERENCES person,
        role text NOT NULL,
        PRIMARY KEY (course_id, person_id)
    )""")
    op.execute("""
    CREATE TABLE note (
        id uuid PRIMARY KEY DEFAULT gen_random_uuid(),
        person_id uuid NOT NULL REFERENCES person,
        note text NOT NULL,
        author text NOT NULL,
        written_at timestamptz NOT NULL DEFAULT now()
    )""")
    op.execute("CREATE INDEX note_person ON note (person_id)")
    op.execute("""
    CREATE TABLE assignment (
        id uuid PRIMARY KEY DEFAULT gen_random_uuid(),
        course_id uuid NOT NULL REFERENCES course,
        slug text NOT NULL,
        published boolean NOT NULL DEFAULT false,
        available_from timestamptz,
        due_at timestamptz,
        grace_s double precision NOT NULL DEFAULT 0,
        submission_limit integer,
        weight double precision NOT NULL DEFAULT 1 CHECK (weight >= 0),
        scores_release text NOT NULL DEFAULT 'immediately'
            CHECK (scores_release IN ('immediately', 'deadline', 'manually')),
        scores_released_at timestamptz,
        details_release text NOT NULL DEFAULT 'immediately'
            CHECK (details_release IN ('immediately', 'deadline', 'manually')),
        details_released_at timestamptz,
        UNIQUE (course_id, slug)
    )""")
    op.execute("""
    CREATE TABLE assignment_version (
        assignment_id uuid REFERENCES assignment,
        version text,
        since timestamptz NOT NULL DEFAULT now(),
        PRIMARY KEY (assignment_id, version)
    )""")
    op.execute("""
    CREATE TABLE extension (
        assignment_id uuid NOT NULL REFERENCES assignment,
        person_id uuid NOT NULL REFERENCES person,
        due_at timestamptz NOT NULL,
        reason text NOT NULL,
        given_by text NOT NULL,
        given_at timestamptz NOT NULL DEFAULT now(),
        PRIMARY KEY (assignment_id, person_id)
    )""")


def _create_accounts() -> None:
    op.execute("""
    CREATE TABLE token (
        id uuid PRIMARY KEY DEFAULT gen_random_uuid(),
        person_id uuid NOT NULL REFERENCES person,
        digest text NOT NULL UNIQUE,
        prefix text NOT NULL,
        label text NOT NULL,
        scopes text[] NOT NULL,
        created_at timestamptz NOT NULL DEFAULT now(),
        expires_at timestamptz NOT NULL,
        used_at timestamptz,
        revoked_at timestamptz
    )""")
    op.execute("CREATE INDEX token_person ON token (person_id)")
    op.execute("""
    CREATE TABLE device_login (
        device_digest text PRIMARY KEY,
        user_code text NOT NULL UNIQUE,
        label text NOT NULL,
        created_at timestamptz NOT NULL DEFAULT now(),
        expires_at timestamptz NOT NULL,
        person_id uuid REFERENCES person, -- null until somebody confirms the login
        refused boolean NOT NULL DEFAULT false
    )""")
    op.execute("""
    CREATE TABLE oidc_account (
        issuer text NOT NULL,
        subject text NOT NULL,
        person_id uuid NOT NULL UNIQUE REFERENCES person,
        since timestamptz NOT NULL DEFAULT now(),
        PRIMARY KEY (issuer, subject)
    )""")


def _create_submissions() -> None:
    op.execute("""
    CREATE TABLE submission (
        id uuid PRIMARY KEY,
        assignment_id uuid NOT NULL REFERENCES assignment,
        person_id uuid NOT NULL REFERENCES person,
        source text NOT NULL,
        sha256 text NOT NULL, -- of the source
        filename text NOT NULL,
        exercises jsonb, -- the numbers requested; null: those that the source attempts
        late boolean NOT NULL DEFAULT false,
        fingerprint text NOT NULL, -- of the request, to compare requests with the same key
        idempotency_key text,
        submitted_at timestamptz NOT NULL DEFAULT now(),
        UNIQUE (person_id, idempotency_key)
    )""")
    op.execute("CREATE INDEX submission_person_assignment ON submission (person_id, assignment_id)")
    op.execute("CREATE INDEX submission_content ON submission (assignment_id, sha256)")
    op.execute("CREATE INDEX submission_submitted_at ON submission (submitted_at)")


def _create_gradings() -> None:
    op.execute("""
    CREATE TABLE regrade (
        id uuid PRIMARY KEY DEFAULT gen_random_uuid(),
        assignment_id uuid NOT NULL REFERENCES assignment,
        description text NOT NULL,
        requested_by text NOT NULL,
        requested_at timestamptz NOT NULL DEFAULT now(),
        decided text,
        decided_by text,
        decided_at timestamptz
    )""")
    op.execute("""
    CREATE TABLE grading (
        id uuid PRIMARY KEY,
        submission_id uuid NOT NULL REFERENCES submission,
        number integer NOT NULL,
        kind text NOT NULL,
        seed bigint NOT NULL,
        max_runs integer NOT NULL,
        requested_at timestamptz NOT NULL DEFAULT now(),
        regrade_id uuid REFERENCES regrade,
        preview boolean NOT NULL DEFAULT false,
        UNIQUE (submission_id, number)
    )""")
    op.execute("CREATE INDEX grading_regrade ON grading (regrade_id) WHERE regrade_id IS NOT NULL")
    op.execute("""
    CREATE TABLE run (
        id uuid PRIMARY KEY,
        grading_id uuid NOT NULL REFERENCES grading,
        worker text NOT NULL, -- its name; a worker's row may be deleted
        started_at timestamptz NOT NULL DEFAULT now(),
        heartbeat_at timestamptz NOT NULL DEFAULT now(),
        phase text NOT NULL DEFAULT '',
        scene integer NOT NULL DEFAULT 0,
        scenes integer NOT NULL DEFAULT 0,
        ended_at timestamptz,
        end_reason text,
        note text,
        scene_at timestamptz NOT NULL DEFAULT now(),
        slow boolean -- null: it ended before it was known
    )""")
    op.execute("CREATE INDEX ix_run_grading_id ON run (grading_id)")
    op.execute("CREATE INDEX run_open ON run (heartbeat_at) WHERE ended_at IS NULL")
    # Exactly one of ``report`` and ``fault`` is set. The scores repeat the report's, for queries.
    op.execute("""
    CREATE TABLE result (
        grading_id uuid PRIMARY KEY REFERENCES grading,
        run_id uuid REFERENCES run,
        report jsonb,
        fault text,
        score integer,
        max_score integer,
        version text,
        isolation text,
        grading_s double precision,
        finished_at timestamptz NOT NULL DEFAULT now(),
        cancelled_by text
    )""")
    op.execute("""
    CREATE TABLE outcome (
        grading_id uuid NOT NULL REFERENCES grading,
        check_id text NOT NULL,
        state text NOT NULL,
        counted boolean NOT NULL,
        margin double precision,
        codes text[] NOT NULL,
        causes text[] NOT NULL,
        points integer NOT NULL,
        earned integer NOT NULL,
        PRIMARY KEY (grading_id, check_id)
    )""")
    op.execute("CREATE TABLE artefact (sha256 text PRIMARY KEY, content bytea NOT NULL)")
    # PNG and float64 arrays do not compress: keep them out of line as they are (PostgreSQL, "TOAST storage").
    op.execute("ALTER TABLE artefact ALTER COLUMN content SET STORAGE EXTERNAL")
    op.execute("""
    CREATE TABLE grading_artefact (
        grading_id uuid REFERENCES grading,
        name text,
        sha256 text NOT NULL REFERENCES artefact,
        PRIMARY KEY (grading_id, name)
    )""")
    op.execute("CREATE INDEX grading_artefact_sha256 ON grading_artefact (sha256)")


def _create_feedback() -> None:
    op.execute("""
    CREATE TABLE override (
        id uuid PRIMARY KEY DEFAULT gen_random_uuid(),
        submission_id uuid NOT NULL REFERENCES submission,
        check_id text, -- null: the points of the whole submission
        points numeric NOT NULL CHECK (points >= 0),
        reason text NOT NULL,
        given_by text NOT NULL,
        given_at timestamptz NOT NULL DEFAULT now(),
        withdrawn_by text,
        withdrawn_at timestamptz
    )""")
    op.execute("""
    CREATE UNIQUE INDEX override_in_force ON override (submission_id, coalesce(check_id, ''))
        WHERE withdrawn_at IS NULL""")
    op.execute("""
    CREATE TABLE regrade_request (
        id uuid PRIMARY KEY DEFAULT gen_random_uuid(),
        submission_id uuid NOT NULL REFERENCES submission,
        check_id text, -- null: the whole submission
        reason text NOT NULL,
        requested_at timestamptz NOT NULL DEFAULT now(),
        status text NOT NULL DEFAULT 'open' CHECK (status IN ('open', 'accepted', 'declined')),
        answer text,
        answered_by text,
        answered_at timestamptz,
        CHECK ((status = 'open') = (answered_at IS NULL))
    )""")
    op.execute("CREATE INDEX regrade_request_submission ON regrade_request (submission_id)")
    op.execute(
        "CREATE UNIQUE INDEX regrade_request_open ON regrade_request (submission_id) WHERE status = 'open'"
    )
    op.execute("""
    CREATE TABLE source_comment (
        id uuid PRIMARY KEY DEFAULT gen_random_uuid(),
        submission_id uuid NOT NULL REFERENCES submission,
        cell integer NOT NULL CHECK (cell > 0),
        line integer NOT NULL CHECK (line > 0),
        comment text NOT NULL,
        author text NOT NULL,
        written_at timestamptz NOT NULL DEFAULT now()
    )""")
    op.execute("CREATE INDEX source_comment_submission ON source_comment (submission_id)")


def _create_operation() -> None:
    op.execute("""
    CREATE TABLE worker (
        name text PRIMARY KEY,
        isolation text, -- null: the worker has no sandbox, for the reason beside it
        unavailable_reason text,
        zygote_restarts integer NOT NULL DEFAULT 0,
        since timestamptz NOT NULL DEFAULT now(),
        seen_at timestamptz NOT NULL DEFAULT now()
    )""")
    op.execute("""
    CREATE TABLE audit (
        id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
        at timestamptz NOT NULL DEFAULT now(),
        actor text NOT NULL,
        action text NOT NULL,
        subject text NOT NULL,
        detail jsonb NOT NULL DEFAULT '{}'
    )""")
    op.execute("CREATE TABLE secret (name text PRIMARY KEY, value text NOT NULL)")


def _create_queue() -> None:
    # Through the driver: SQLAlchemy would look for parameters in Procrastinate's text.
    driver = op.get_bind().connection.driver_connection
    driver.execute(SchemaManager.get_schema())  # type: ignore[union-attr]
    op.execute("CREATE INDEX job_of_grading ON procrastinate_jobs ((args->>'attempt'))")


def _forbid_changes() -> None:
    op.execute("""
    CREATE FUNCTION refuse_to_alter() RETURNS trigger LANGUAGE plpgsql AS
        $$ BEGIN RAISE 'a % is never altered', TG_TABLE_NAME; END $$""")
    for table in ("submission", "result"):
        op.execute(f"""
        CREATE TRIGGER {table}_is_never_altered BEFORE UPDATE ON {table}
            FOR EACH ROW EXECUTE FUNCTION refuse_to_alter()""")


def _insert_first_rows() -> None:
    # The student without login of a server that runs for one person.
    op.execute("INSERT INTO course (slug) VALUES ('local')")
    op.execute("INSERT INTO person (name) VALUES ('local')")
    op.execute("INSERT INTO member SELECT course.id, person.id, 'student' FROM course, person")
    # Signs the forms of the pages.
    op.execute("INSERT INTO secret VALUES ('forms', gen_random_uuid()::text || gen_random_uuid()::text)")
