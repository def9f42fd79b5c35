"""Declare the tables of the database.

A submission is immutable. A submission has gradings, and a grading has runs: one per worker that started
it. The first run to finish records the grading's only result, with its artefacts in the same transaction. A
preview grading belongs to a regrade that has not been applied; pages and grades ignore it. An override sets
the points of a check or, without a check, of the whole submission; at most one of each is in force.
"""

from sqlalchemy import (
    ARRAY,
    BigInteger,
    Boolean,
    CheckConstraint,
    Column,
    DateTime,
    Float,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    Table,
    Text,
    UniqueConstraint,
    Uuid,
    func,
    text,
)
from sqlalchemy.dialects.postgresql import JSONB

metadata = MetaData()


def _id() -> Column[object]:
    return Column("id", Uuid, primary_key=True, server_default=text("gen_random_uuid()"))


def _at(name: str, *, now: bool = False) -> Column[object]:
    return Column(name, DateTime(timezone=True), nullable=not now, server_default=func.now() if now else None)


course = Table(
    "course", metadata, _id(), Column("slug", Text, nullable=False, unique=True), Column("title", Text, nullable=False),
)  # fmt: skip

person = Table(
    "person",
    metadata,
    _id(),
    Column("name", Text, nullable=False, unique=True),
    Column("full_name", Text, nullable=False, server_default=""),
    Column("email", Text, nullable=False, server_default=""),
    Column("student_id", Text, nullable=False, server_default=""),
    Column("password", Text, nullable=True),
    _at("created_at", now=True),
)

secret = Table("secret", metadata, Column("name", Text, primary_key=True), Column("value", Text, nullable=False))

member = Table(
    "member",
    metadata,
    Column("course_id", Uuid, ForeignKey("course.id"), primary_key=True),
    Column("person_id", Uuid, ForeignKey("person.id"), primary_key=True),
    Column("role", Text, nullable=False),
)

token = Table(
    "token",
    metadata,
    _id(),
    Column("person_id", Uuid, ForeignKey("person.id"), nullable=False),
    Column("digest", Text, nullable=False, unique=True),
    Column("prefix", Text, nullable=False),
    Column("label", Text, nullable=False),
    Column("scopes", ARRAY(Text), nullable=False),
    _at("created_at", now=True),
    Column("expires_at", DateTime(timezone=True), nullable=False),
    _at("used_at"),
    _at("revoked_at"),
)

Index("token_person", token.c.person_id)

oidc_account = Table(
    "oidc_account",
    metadata,
    Column("issuer", Text, primary_key=True),
    Column("subject", Text, primary_key=True),
    Column("person_id", Uuid, ForeignKey("person.id"), nullable=False, unique=True),
    _at("since", now=True),
)

device_login = Table(
    "device_login",
    metadata,
    Column("device_digest", Text, primary_key=True),
    Column("user_code", Text, nullable=False, unique=True),
    Column("label", Text, nullable=False),
    _at("created_at", now=True),
    Column("expires_at", DateTime(timezone=True), nullable=False),
    Column("person_id", Uuid, ForeignKey("person.id"), nullable=True),
    Column("refused", Boolean, nullable=False, server_default="false"),
)

assignment = Table(
    "assignment",
    metadata,
    _id(),
    Column("course_id", Uuid, ForeignKey("course.id"), nullable=False),
    Column("slug", Text, nullable=False),
    _at("due_at"),
    Column("grace_s", Float, nullable=False, server_default="0"),
    Column("submission_limit", Integer, nullable=True),
    Column("weight", Float, CheckConstraint("weight >= 0"), nullable=False, server_default="1"),
    UniqueConstraint("course_id", "slug"),
)

assignment_version = Table(
    "assignment_version",
    metadata,
    Column("assignment_id", Uuid, ForeignKey("assignment.id"), primary_key=True),
    Column("version", Text, primary_key=True),
    _at("since", now=True),
)

extension = Table(
    "extension",
    metadata,
    Column("assignment_id", Uuid, ForeignKey("assignment.id"), primary_key=True),
    Column("person_id", Uuid, ForeignKey("person.id"), primary_key=True),
    Column("due_at", DateTime(timezone=True), nullable=False),
    Column("reason", Text, nullable=False),
    Column("given_by", Text, nullable=False),
    _at("given_at", now=True),
)

submission = Table(
    "submission",
    metadata,
    Column("id", Uuid, primary_key=True),
    Column("assignment_id", Uuid, ForeignKey("assignment.id"), nullable=False),
    Column("person_id", Uuid, ForeignKey("person.id"), nullable=False),
    Column("source", Text, nullable=False),
    Column("sha256", Text, nullable=False),
    Column("filename", Text, nullable=False),
    Column("exercises", JSONB(none_as_null=True), nullable=True),
    Column("late", Boolean, nullable=False, server_default="false"),
    Column("fingerprint", Text, nullable=False),
    Column("idempotency_key", Text, nullable=True),
    _at("submitted_at", now=True),
    UniqueConstraint("person_id", "idempotency_key"),
)
Index("submission_person_assignment", submission.c.person_id, submission.c.assignment_id)
Index("submission_submitted_at", submission.c.submitted_at)

regrade = Table(
    "regrade",
    metadata,
    _id(),
    Column("assignment_id", Uuid, ForeignKey("assignment.id"), nullable=False),
    Column("description", Text, nullable=False),
    Column("requested_by", Text, nullable=False),
    _at("requested_at", now=True),
    Column("decided", Text, nullable=True),
    Column("decided_by", Text, nullable=True),
    _at("decided_at"),
)

grading = Table(
    "grading",
    metadata,
    Column("id", Uuid, primary_key=True),
    Column("submission_id", Uuid, ForeignKey("submission.id"), nullable=False),
    Column("number", Integer, nullable=False),
    Column("kind", Text, nullable=False),
    Column("seed", BigInteger, nullable=False),
    Column("max_runs", Integer, nullable=False),
    _at("requested_at", now=True),
    Column("regrade_id", Uuid, ForeignKey("regrade.id"), nullable=True),
    Column("preview", Boolean, nullable=False, server_default="false"),
    UniqueConstraint("submission_id", "number"),
)
Index("grading_regrade", grading.c.regrade_id, postgresql_where=grading.c.regrade_id.is_not(None))

run = Table(
    "run",
    metadata,
    Column("id", Uuid, primary_key=True),
    Column("grading_id", Uuid, ForeignKey("grading.id"), nullable=False, index=True),
    Column("worker", Text, nullable=False),
    _at("started_at", now=True),
    _at("heartbeat_at", now=True),
    Column("phase", Text, nullable=False, server_default=""),
    Column("scene", Integer, nullable=False, server_default="0"),
    Column("scenes", Integer, nullable=False, server_default="0"),
    _at("scene_at", now=True),
    _at("ended_at"),
    Column("end_reason", Text, nullable=True),
    Column("note", Text, nullable=True),
)
Index("run_open", run.c.heartbeat_at, postgresql_where=run.c.ended_at.is_(None))

result = Table(
    "result",
    metadata,
    Column("grading_id", Uuid, ForeignKey("grading.id"), primary_key=True),
    Column("run_id", Uuid, ForeignKey("run.id"), nullable=True),
    Column("report", JSONB(none_as_null=True), nullable=True),
    Column("fault", Text, nullable=True),
    Column("score", Integer, nullable=True),
    Column("max_score", Integer, nullable=True),
    Column("version", Text, nullable=True),
    Column("isolation", Text, nullable=True),
    Column("grading_s", Float, nullable=True),
    Column("cancelled_by", Text, nullable=True),
    _at("finished_at", now=True),
)

outcome = Table(
    "outcome",
    metadata,
    Column("grading_id", Uuid, ForeignKey("grading.id"), primary_key=True),
    Column("check_id", Text, primary_key=True),
    Column("state", Text, nullable=False),
    Column("counted", Boolean, nullable=False),
    Column("margin", Float, nullable=True),
    Column("codes", ARRAY(Text), nullable=False),
    Column("causes", ARRAY(Text), nullable=False),
    Column("points", Integer, nullable=False),
    Column("earned", Integer, nullable=False),
)

override = Table(
    "override",
    metadata,
    _id(),
    Column("submission_id", Uuid, ForeignKey("submission.id"), nullable=False),
    Column("check_id", Text, nullable=True),
    Column("points", Integer, nullable=False),
    Column("reason", Text, nullable=False),
    Column("given_by", Text, nullable=False),
    _at("given_at", now=True),
    Column("withdrawn_by", Text, nullable=True),
    _at("withdrawn_at"),
)
Index(
    "override_in_force", override.c.submission_id, func.coalesce(override.c.check_id, ""), unique=True,
    postgresql_where=override.c.withdrawn_at.is_(None),
)  # fmt: skip

artefact = Table(
    "artefact", metadata, Column("sha256", Text, primary_key=True), Column("content", LargeBinary, nullable=False),
)  # fmt: skip

grading_artefact = Table(
    "grading_artefact",
    metadata,
    Column("grading_id", Uuid, ForeignKey("grading.id"), primary_key=True),
    Column("name", Text, primary_key=True),
    Column("sha256", Text, ForeignKey("artefact.sha256"), nullable=False),
)

worker = Table(
    "worker",
    metadata,
    Column("name", Text, primary_key=True),
    Column("isolation", Text, nullable=True),
    Column("unavailable_reason", Text, nullable=True),
    Column("zygote_restarts", Integer, nullable=False, server_default="0"),
    _at("since", now=True),
    _at("seen_at", now=True),
)

audit = Table(
    "audit",
    metadata,
    Column("id", BigInteger, primary_key=True),
    _at("at", now=True),
    Column("actor", Text, nullable=False),
    Column("action", Text, nullable=False),
    Column("subject", Text, nullable=False),
    Column("detail", JSONB, nullable=False, server_default="{}"),
)
