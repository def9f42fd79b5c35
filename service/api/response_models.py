"""The JSON that API v1 returns, as models. Fields are added, never removed."""

import types
from dataclasses import fields, is_dataclass
from datetime import datetime
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints
from uuid import UUID

from pydantic import BaseModel, Field, GetPydanticSchema, PlainSerializer, WithJsonSchema, create_model

from polhode.report.report import Report
from service.store.course import regrade_requests

Moment = Annotated[
    datetime, PlainSerializer(datetime.isoformat), WithJsonSchema({"type": "string", "format": "date-time"})
]
Status = Literal["queued", "running", "graded", "faulted"]


def model_of(kind: Any) -> Any:
    """Return the type of what ``polhode.report.dataclass_json`` writes for values of the type ``kind``; of a
    dataclass, a model.
    """
    if is_dataclass(kind):
        assert isinstance(kind, type)
        hints, members = get_type_hints(kind), dict[str, Any]()
        for field in fields(kind):
            if not field.metadata.get("local_only"):
                members[field.name] = model_of(hints[field.name]), ...
        for name in getattr(kind, "COMPUTED_FIELDS", ()):
            members[name] = get_type_hints(getattr(kind, name).fget)["return"], ...
        return create_model(kind.__name__, __doc__=kind.__doc__, **members)
    if get_origin(kind) is types.UnionType:
        return Union[tuple(map(model_of, get_args(kind)))]  # noqa: UP007
    if get_origin(kind) is not None:
        return get_origin(kind)[tuple(map(model_of, get_args(kind)))]
    return float | None if kind is float else kind


_REPORT = model_of(Report).__pydantic_core_schema__
# ``polhode.report.dataclass_json`` has written it, so it is described but not validated again.
ReportDocument = Annotated[
    dict[str, Any], GetPydanticSchema(get_pydantic_json_schema=lambda _, handler: handler(_REPORT))
]


class Named(BaseModel):
    """An assignment; ``available_from`` is null once students can see it."""

    slug: str
    title: str
    version: str
    available_from: Moment | None = None


class Check(BaseModel):
    """A check of an exercise; ``tolerance`` has the numbers it uses, and its ``reason``."""

    id: str
    label: str
    hidden: bool
    self_reported: bool
    tolerance: dict[str, float | str]


class Exercise(BaseModel):
    """A numbered section with its functions and checks."""

    number: str
    title: str
    functions: list[str]
    optional: list[str]
    variables: list[str]
    checks: list[Check]


class Described(Named):
    """An assignment with its exercises, its kit and the packages that submissions can import."""

    exercises: list[Exercise]
    kit: str
    kit_build: str
    notebook: str
    packages: dict[str, str]


class Override(BaseModel):
    """An instructor's override of a check's points, or of the whole submission (check null)."""

    check: str | None
    points: int | float
    reason: str
    by: str
    at: Moment


class RegradeRequest(BaseModel):
    """A student's request for a regrade of a check, null for the whole submission; ``answer``,
    ``answered_by`` and ``answered_at`` are null while it is open.
    """

    id: UUID
    submission: UUID
    check: str | None
    reason: str
    requested_at: Moment
    status: regrade_requests.Status
    answer: str | None
    answered_by: str | None
    answered_at: Moment | None


class ListedRegradeRequest(RegradeRequest):
    """A request with the student who made it and the present points of the submission."""

    person: str
    full_name: str
    points: int | None
    total: int | None


class Comment(BaseModel):
    """A comment of the staff on line ``line`` of code cell ``cell``, both counted from 1. A Python file is
    one cell.
    """

    id: UUID
    cell: int
    line: int
    comment: str
    author: str
    written_at: Moment


class Submission(BaseModel):
    """A submission. Fields that do not apply are missing."""

    id: UUID
    status: Status
    submitted_at: Moment
    late: bool
    sha256: str
    report: ReportDocument | None = None
    system_fault: str = ""
    cancelled_by: str = ""
    repeated: bool = False
    points: int | float = 0
    penalty: int | float = Field(0, description="Points lost for being late.")
    final: int | float = Field(0, description="Points after the penalty.")
    scores_released: bool = Field(
        True, description="False if the report is withheld until the scores are released."
    )
    overrides: list[Override] = []
    regrade_requests: list[RegradeRequest] = []
    comments: list[Comment] = []


class Changed(BaseModel):
    """The changes from the previous submission: verdicts by check id, and a sentence."""

    checks: dict[str, list[str]]
    summary: str


class Past(BaseModel):
    """A submission in a list."""

    id: UUID
    submitted_at: Moment
    late: bool
    filename: str
    status: Status
    score: int | None
    max_score: int | None
    total: int | None
    points: int | float | None
    penalty: int | float
    final: int | float | None
    scores_released: bool
    sha256: str
    verdicts: dict[str, str]
    comments: int
    regrade_request: regrade_requests.Status | None
    changed: Changed | None


class History(BaseModel):
    """A person's submissions to an assignment, newest first, the ids of the best and the last, and the
    person's own rules.

    ``due_at`` is the deadline with an extension, if it is ``extended``; with ``grace_s`` seconds more it is
    ``over``. ``used`` counts the submissions towards ``submission_limit``. ``max_points`` are those of the
    assignment without optional functions, which are worth ``bonus_points``.
    """

    assignment: str
    max_points: int
    bonus_points: int
    submissions: list[Past]
    best: UUID | None
    last: UUID | None
    due_at: Moment | None
    extended: bool
    grace_s: float
    over: bool
    submission_limit: int | None
    used: int


class Ready(BaseModel):
    """Whether submissions can be graded."""

    status: Literal["ready", "not ready"]
    checks: dict[str, str]
