"""Health endpoints: liveness, readiness and metrics."""

import time

import psycopg
from fastapi import APIRouter, Response
from fastapi.responses import JSONResponse

from exercises.authoring.assignments import course_packages
from exercises.authoring.assignments.catalogue import load_catalogue
from service.api.response_models import Ready
from service.http.metrics import exposition
from service.http.openapi import also, media, problems
from service.http.state import Db, Held
from service.store.database import Database, DatabaseLost, is_loss
from service.store.schema import MISSING_TABLES

router = APIRouter(tags=["Health and metrics"])
CACHED_S = 1.0

_WORKERS = """
SELECT name, isolation, unavailable_reason FROM worker WHERE seen_at BETWEEN now() - interval '10 s'
  AND now() + interval '10 s'
ORDER BY unavailable_reason IS NOT NULL, name
"""


# A megabyte, more than a submission with its result takes. The rows do not fit in so little memory, so
# PostgreSQL writes them to a temporary file on its disk.
_LITTLE_MEMORY = "SET LOCAL work_mem = '64kB'"
_FILL = "SELECT count(*) FROM generate_series(1, 40000)"


class WorkerStatus:
    """The readiness of the workers and of the database's disk, found out at most once a second."""

    def __init__(self, database: Database) -> None:
        self._database, self._read_at, self._had_room_at = database, float("-inf"), float("-inf")
        self._current: tuple[str | None, str | None] = None, None

    async def current(self) -> tuple[str | None, str | None]:
        """Return the isolation of a worker that can grade and the reason why another one cannot, each
        None if there is no such worker.
        """
        now = time.monotonic()
        if now - self._read_at > CACHED_S:
            workers = await self._database.rows(_WORKERS)
            self._current = (
                next((w.isolation for w in workers if w.isolation), None),
                next((w.unavailable_reason for w in workers if w.unavailable_reason), None),
            )
            self._read_at = now
        return self._current

    async def check_room(self) -> None:
        """Raise psycopg's DiskFull if the database has no room for a submission."""
        now = time.monotonic()
        if now - self._had_room_at > CACHED_S:
            async with self._database.begin() as connection:
                await connection.execute(_LITTLE_MEMORY)
                await connection.rows(_FILL)
            self._had_room_at = now


@router.get("/livez", responses=problems({}))
async def livez() -> dict[str, str]:
    """Report that the process is alive."""
    return {"status": "alive"}


@router.get("/readyz", response_model=Ready, responses=problems({}) | also(503, "Not ready", Ready))
async def readyz(database: Db, status: Held[WorkerStatus]) -> JSONResponse:
    """Report whether submissions can be graded, with the result of each check."""
    checks = {"isolation": "no worker is running: start one with polhode worker", "database": "ok"}
    # A broken assignment does not make the server unready: the others can be graded.
    broken = load_catalogue().invalid
    invalid = {"assignments": f"broken: {', '.join(broken)}"} if broken else {}
    if wrong := course_packages.errors():
        invalid["course"] = "; ".join(wrong)
    try:
        if missing := [row.name for row in await database.rows(MISSING_TABLES)]:
            raise DatabaseLost(f"tables are missing: {', '.join(missing)}")
        await status.check_room()
        isolation, reason = await status.current()
        checks["isolation"] = isolation or reason or checks["isolation"]
    except Exception as error:
        isolation, checks = None, {"isolation": "unknown", "database": _reason(error)}
    if isolation is None:
        return JSONResponse({"status": "not ready", "checks": checks | invalid}, 503, {"Retry-After": "5"})
    return JSONResponse({"status": "ready", "checks": checks | invalid})


def _reason(error: Exception) -> str:
    if isinstance(error, psycopg.errors.DiskFull):
        return "its disk is full, so no submission is accepted: free some space"
    return f"lost: {str(error).splitlines()[0]}" if is_loss(error) else type(error).__name__


@router.get("/metrics", response_class=Response, responses=media("text/plain") | problems({503: "busy"}))
async def metrics(database: Db) -> Response:
    """Return all metrics for Prometheus."""
    return Response(await exposition(database), media_type="text/plain; version=0.0.4")
