"""Logs: one JSON object per line on stderr, with the ids of the request and of the grading concerned."""

import logging
import sys
from contextvars import ContextVar
from typing import TextIO

from pythonjsonlogger.core import RESERVED_ATTRS
from pythonjsonlogger.json import JsonFormatter

request_id: ContextVar[str | None] = ContextVar("request_id", default=None)
grading_id: ContextVar[str | None] = ContextVar("grading_id", default=None)


def install(level: str) -> None:
    """Log to stderr from ``level`` on; messages of libraries only from warnings on."""
    logging.basicConfig(level=level.upper(), handlers=[handler(sys.stderr)], force=True)
    for library in ("procrastinate", "alembic", "psycopg.pool", "uvicorn.access", "asyncio"):
        logging.getLogger(library).setLevel(max(logging.WARNING, logging.root.level))


def handler(stream: TextIO) -> logging.Handler:
    """Return a handler that writes log records as JSON lines to ``stream``."""
    lines = logging.StreamHandler(stream)
    fields = ["levelname", "name", "message"]
    lines.setFormatter(
        JsonFormatter(
            fields,
            timestamp=True,
            reserved_attrs=[*RESERVED_ATTRS, "color_message"],
            rename_fields={"levelname": "level", "name": "logger"},
        )
    )
    lines.addFilter(_with_ids)
    return lines


def _with_ids(record: logging.LogRecord) -> bool:
    # "attempt" is the former name of "grading".
    for name, value in (("request", request_id.get()), ("attempt", grading_id.get()), ("grading", grading_id.get())):
        if value is not None:
            setattr(record, name, value)
    return True
