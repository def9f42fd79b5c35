"""The web application: routes, pages and problems over one store and one grader."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from fastapi import FastAPI, Request, Response
from fastapi.staticfiles import StaticFiles

from service import pages, problems, routes
from service.grader import Grader
from service.settings import Settings
from service.store.migrate import migrate
from service.store.store import Store

CONTENT_SECURITY = "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; form-action 'self'"


def create_app(settings: Settings) -> FastAPI:
    """The application for a database that is there: ``settings.database_url`` is set.

    Without walls, or with walls that have a hole, it starts and shows what there is, and takes no submission.
    """
    if settings.database_url is None:
        raise ValueError("create_app needs settings.database_url; polhode serve starts an embedded database for it")
    app = FastAPI(title="polhode", version="1", lifespan=_lifespan, docs_url=None, redoc_url=None)
    app.state.settings = settings
    problems.install(app)
    app.middleware("http")(_guard)
    app.include_router(routes.router)
    app.include_router(pages.router, include_in_schema=False)
    app.mount("/static", StaticFiles(directory=Path(__file__).parent / "static"))
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    settings: Settings = app.state.settings
    assert settings.database_url is not None
    await asyncio.to_thread(migrate, settings.database_url)
    app.state.store = Store(settings.database_url)
    app.state.grader = Grader(app.state.store, settings.min_tier, settings.workers)
    try:
        await app.state.grader.start()
        yield
    finally:
        await app.state.grader.stop()
        await app.state.store.close()


async def _guard(request: Request, call_next):  # type: ignore[no-untyped-def]
    response: Response = await call_next(request)
    response.headers["Content-Security-Policy"] = CONTENT_SECURITY
    response.headers["X-Content-Type-Options"] = "nosniff"
    return response
