"""Is the server alive, can it grade, and how is it doing."""

import time

from fastapi import APIRouter, Request, Response
from fastapi.responses import JSONResponse

from exercises.catalogue import load_catalogue
from service.http.metrics import exposition
from service.store.database import Database

router = APIRouter()
KNOWN_FOR_S = 1.0

_CREW = """
SELECT name, isolation, unavailable_reason FROM worker WHERE seen_at > now() - interval '10 s'
ORDER BY unavailable_reason IS NOT NULL, name
"""


@router.get("/livez")
async def livez() -> dict[str, str]:
    """The process is alive."""
    return {"status": "alive"}


@router.get("/readyz")
async def readyz(request: Request) -> JSONResponse:
    """Whether submissions can be graded, and what was checked."""
    checks = {"database": "ok"}
    sandbox = "no worker is registered"
    invalid = (
        {"assignments": f"broken: {', '.join(load_catalogue().invalid)}"} if load_catalogue().invalid else {}
    )  # the others can be graded
    try:
        await request.app.state.database.ping()
        isolation, refusal = await request.app.state.crew.known()
        sandbox = isolation or refusal or sandbox
    except Exception as error:
        isolation, sandbox, checks = None, "unknown", {"database": type(error).__name__}
    checks = {"isolation": sandbox, "walls": sandbox} | checks  # "walls" is the former name
    if isolation is None:
        return JSONResponse({"status": "not ready", "checks": checks | invalid}, 503, {"Retry-After": "5"})
    return JSONResponse({"status": "ready", "checks": checks | invalid})


@router.get("/metrics")
async def metrics(request: Request) -> Response:
    """Everything counted, for Prometheus."""
    return Response(await exposition(request.app.state.database), media_type="text/plain; version=0.0.4")


class WorkerStatus:
    """Who grades, as the workers tell it; asked for at most once a second."""

    def __init__(self, database: Database) -> None:
        self._database, self._asked = database, float("-inf")
        self._known: tuple[str | None, str | None] = None, None

    async def known(self) -> tuple[str | None, str | None]:
        """Return the isolation of a worker that grades, and the reason why another one does not. Each may be None."""
        now = time.monotonic()
        if now - self._asked > KNOWN_FOR_S:
            load_catalogue = await self._database.rows(_CREW)
            self._known = (
                next((w.isolation for w in load_catalogue if w.isolation), None),
                next((w.unavailable_reason for w in load_catalogue if w.unavailable_reason), None),
            )
            self._asked = now
        return self._known
