"""The web application: API, pages and live updates. No code of a submission runs in this process."""

import logging
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path

from fastapi import FastAPI
from fastapi.middleware.cors import CORSMiddleware
from fastapi.staticfiles import StaticFiles

from exercises.catalogue import load_catalogue
from service.api import events, exports, figures, health, history, kit, parse_submission, submissions
from service.api.figure_renderer import Renderer
from service.auth import device_login, forms, oidc, roles
from service.auth.jupyterhub import Hub
from service.auth.passwords import PasswordChecker
from service.auth.rate_limit import LoginRateLimiter
from service.http import errors, middleware, openapi
from service.http.live import ChangeFeed, Listener
from service.http.templating import ENVIRONMENT
from service.pages import account, course, gradebook, login, overrides, queue, regrades, speed_vs_accuracy, submission
from service.settings import Settings
from service.store import queue_overview
from service.store.course.people import secret
from service.store.database import Database
from service.store.submissions import register

log = logging.getLogger(__name__)
ROUTERS = (
    health.router,
    submissions.router,
    history.router,
    events.router,
    figures.router,
    device_login.router,
    kit.router,
)
PAGES = (
    course.router,
    gradebook.router,
    exports.router,
    queue.router,
    regrades.router,
    overrides.router,
    speed_vs_accuracy.router,
    submission.router,
    login.router,
    account.router,
    oidc.router,
)
ENVIRONMENT.globals["csrf"] = forms.csrf_field
ALLOWED = ["Authorization", "Content-Type", "Idempotency-Key", "Last-Event-ID", "Prefer"]
EXPOSED = ["ETag", "Location", "Retry-After", "X-Request-Id"]


def create_app(settings: Settings, find_loss: Callable[[], str | None] = lambda: None) -> FastAPI:
    """Return the application for a migrated database; ``find_loss`` returns the reason why the files of an
    embedded database are lost, or None.

    Raises ValueError if ``settings.database_url`` is not set.
    """
    if settings.database_url is None:
        raise ValueError("create_app needs settings.database_url; polhode serve starts an embedded database for it")
    app = FastAPI(title="polhode", version="1", lifespan=_lifespan, docs_url=None, redoc_url=None)
    app.state.settings, app.state.oidc, app.state.find_loss = settings, oidc.provider(settings), find_loss
    errors.install(app)
    openapi.install(app)
    roles.install(app)
    if origins := settings.allowed_origins():
        methods = ["GET", "POST", "DELETE"]
        app.add_middleware(
            CORSMiddleware, allow_origins=origins, allow_methods=methods, allow_headers=ALLOWED, expose_headers=EXPOSED
        )
    middleware.install(app)
    for router in ROUTERS:
        app.include_router(router)
    for router in PAGES:
        app.include_router(router, include_in_schema=False)
    app.mount("/static", StaticFiles(directory=Path(__file__).parent / "pages" / "static"))
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    settings: Settings = app.state.settings
    assert settings.database_url is not None
    app.state.database = database = Database(
        settings.database_url, "polhode web", connections=10, wait_s=settings.database_wait, find_loss=app.state.find_loss
    )
    valid, invalid = load_catalogue()
    await register(database, valid.values())
    for broken in invalid.values():
        log.error("%s", broken)
    app.state.secret = await secret(database, "forms")
    app.state.hub = Hub(settings.hub_api_url, settings.hub_service)
    app.state.password_checker, app.state.login_limiter = PasswordChecker(database), LoginRateLimiter()
    app.state.worker_status = health.WorkerStatus(database)
    app.state.listener, app.state.renderer = Listener(database), Renderer()
    app.state.large_bodies = parse_submission.LargeBodies(settings)
    app.state.listener.start()
    app.state.queue = ChangeFeed(
        app.state.listener, lambda: queue_overview.snapshot(database), partial(queue.snapshot, lease_s=settings.lease)
    )
    try:
        yield
    finally:
        app.state.renderer.stop()
        app.state.large_bodies.process.stop()
        app.state.hub.stop()
        app.state.password_checker.stop()
        await app.state.listener.stop()
        await database.close()
