"""Logs: one JSON object per line on stderr, with the ids of the request and of the grading concerned."""

import logging
import sys
import time
from contextvars import ContextVar
from typing import TextIO

from pythonjsonlogger.core import RESERVED_ATTRS
from pythonjsonlogger.json import JsonFormatter

request_id: ContextVar[str | None] = ContextVar("request_id", default=None)
MOST_LINES, PERIOD_S = 60, 60.0  # of warnings and errors from one line of code

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
    lines.addFilter(RepetitionLimit())
    lines.addFilter(_with_ids)
    return lines


class RepetitionLimit(logging.Filter):
    """Passes at most MOST_LINES warnings and errors per PERIOD_S from one line of code, so that no client can
    fill the log.

    The next line that passes has the number of those left out in its field ``left_out``.
    """

    def __init__(self) -> None:
        super().__init__()
        self._periods: dict[tuple[str, int], tuple[float, int]] = {}  # start and number of lines

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether to log the record."""
        if record.levelno < logging.WARNING:
            return True
        key, now = (record.pathname, record.lineno), time.monotonic()
        start, lines = self._periods.get(key, (now, 0))
        if now - start >= PERIOD_S:
            if lines > MOST_LINES:
                record.left_out = lines - MOST_LINES
            start, lines = now, 0
        self._periods[key] = start, lines + 1
        return lines < MOST_LINES


def _with_ids(record: logging.LogRecord) -> bool:
    for name, value in (("request", request_id.get()), ("grading", grading_id.get())):
        if value is not None:
            setattr(record, name, value)
    return True
