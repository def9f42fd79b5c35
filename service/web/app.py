"""The web application: it accepts, tells and shows. Nothing of a submission runs in this process."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from fastapi import FastAPI
from fastapi.staticfiles import StaticFiles

from exercises.assignment import assignments
from service.settings import Settings
from service.store.accept import register
from service.store.database import Database
from service.web import events, guard, health, pages, pictures, problems, routes
from service.web.drawing import Draughtsman
from service.web.listener import Listener

ROUTERS = (health.router, routes.router, events.router, pictures.router)


def create_app(settings: Settings) -> FastAPI:
    """The application for a database that is there and up to date: ``settings.database_url`` is set."""
    if settings.database_url is None:
        raise ValueError("create_app needs settings.database_url; polhode serve starts an embedded database for it")
    app = FastAPI(title="polhode", version="1", lifespan=_lifespan, docs_url=None, redoc_url=None)
    app.state.settings = settings
    problems.install(app)
    guard.install(app)
    for router in ROUTERS:
        app.include_router(router)
    app.include_router(pages.router, include_in_schema=False)
    app.mount("/static", StaticFiles(directory=Path(__file__).parent / "static"))
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    settings: Settings = app.state.settings
    assert settings.database_url is not None
    app.state.database = database = Database(settings.database_url, "polhode web", connections=10)
    await register(database, assignments().values())
    app.state.crew = health.Crew(database)
    app.state.listener, app.state.draughtsman = Listener(database), Draughtsman()
    app.state.listener.start()
    try:
        yield
    finally:
        app.state.draughtsman.stop()
        await app.state.listener.stop()
        await database.close()
