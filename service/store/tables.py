"""The tables. A submission is never altered; its result is written once; artefacts belong to the result's transaction."""

from sqlalchemy import JSON, BigInteger, Column, DateTime, ForeignKey, LargeBinary, MetaData, Table, Text, Uuid, func
from sqlalchemy.dialects.postgresql import JSONB

metadata = MetaData()

submission = Table(
    "submission",
    metadata,
    Column("id", Uuid, primary_key=True),
    Column("assignment", Text, nullable=False),
    Column("source", Text, nullable=False),
    Column("filename", Text, nullable=False),
    Column("exercises", JSON, nullable=True),
    Column("seed", BigInteger, nullable=False),
    Column("fingerprint", Text, nullable=False),
    Column("idempotency_key", Text, nullable=True, unique=True),
    Column("submitted_at", DateTime(timezone=True), nullable=False, server_default=func.now()),
)

result = Table(
    "result",
    metadata,
    Column("submission_id", Uuid, ForeignKey("submission.id"), primary_key=True),
    Column("report", JSONB, nullable=True),
    Column("fault", Text, nullable=True),
    Column("finished_at", DateTime(timezone=True), nullable=False, server_default=func.now()),
)

artefact = Table(
    "artefact",
    metadata,
    Column("submission_id", Uuid, ForeignKey("submission.id"), primary_key=True),
    Column("name", Text, primary_key=True),
    Column("sha256", Text, nullable=False),
    Column("content", LargeBinary, nullable=False),
)
