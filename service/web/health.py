"""Is the server alive, can it grade, and how is it doing."""

from fastapi import APIRouter, Request, Response
from fastapi.responses import JSONResponse

from service.store.database import Database
from service.web.counters import exposition

router = APIRouter()

_CREW = """
SELECT name, walls, refusal FROM worker WHERE seen_at > now() - interval '10 s' ORDER BY refusal IS NOT NULL, name
"""


@router.get("/livez")
async def livez() -> dict[str, str]:
    """The process is alive."""
    return {"status": "alive"}


@router.get("/readyz")
async def readyz(request: Request) -> JSONResponse:
    """Whether submissions can be graded, and what was checked."""
    checks = {"walls": "no worker has been heard of", "database": "ok"}
    try:
        walls, refusal = await crew(request.app.state.database)
        checks["walls"] = walls or refusal or checks["walls"]
    except Exception as error:
        walls, checks = None, {"walls": "unknown", "database": type(error).__name__}
    if walls is None:
        return JSONResponse({"status": "not ready", "checks": checks}, 503, {"Retry-After": "5"})
    return JSONResponse({"status": "ready", "checks": checks})


@router.get("/metrics")
async def metrics(request: Request) -> Response:
    """Everything counted, for Prometheus."""
    return Response(await exposition(request.app.state.database), media_type="text/plain; version=0.0.4")


async def crew(database: Database) -> tuple[str | None, str | None]:
    """The walls of a worker that is there and grades, and why another one does not; None where there is none."""
    found = await database.rows(_CREW)
    return next((w.walls for w in found if w.walls), None), next((w.refusal for w in found if w.refusal), None)
