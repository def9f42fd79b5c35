"""Store the course's time zone and late penalty, when scores and details are released, notes on people, and
fractions of points.
"""

from alembic import op

revision = "0010"
down_revision = "0009"

SETTINGS = """
ALTER TABLE course ADD time_zone text NOT NULL DEFAULT 'UTC',
    ADD late_penalty double precision NOT NULL DEFAULT 0 CHECK (late_penalty BETWEEN 0 AND 1),
    ADD late_penalty_limit double precision NOT NULL DEFAULT 1 CHECK (late_penalty_limit BETWEEN 0 AND 1);
ALTER TABLE assignment
    ADD scores_release text NOT NULL DEFAULT 'immediately' CHECK (scores_release IN ('immediately', 'deadline', 'manually')),
    ADD scores_released_at timestamptz,
    ADD details_release text NOT NULL DEFAULT 'immediately' CHECK (details_release IN ('immediately', 'deadline', 'manually')),
    ADD details_released_at timestamptz;
ALTER TABLE override ALTER points TYPE numeric;
CREATE TABLE note (
    id uuid PRIMARY KEY DEFAULT gen_random_uuid(), person_id uuid NOT NULL REFERENCES person, note text NOT NULL,
    author text NOT NULL, written_at timestamptz NOT NULL DEFAULT now()
);
CREATE INDEX note_person ON note (person_id);
"""


def upgrade() -> None:
    op.execute(SETTINGS)
