"""The web application: API, pages and live updates. No code of a submission runs in this process."""

import logging
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path

from fastapi import Depends, FastAPI
from fastapi.middleware.cors import CORSMiddleware
from fastapi.middleware.gzip import GZipMiddleware
from fastapi.staticfiles import StaticFiles

from exercises.authoring.assignments import course_packages
from exercises.authoring.assignments.catalogue import load_catalogue
from service.api import (
    events,
    exports,
    figures,
    health,
    kit,
    parse_submission,
    submissions,
)
from service.api import (
    past_submissions as history,
)
from service.api import (
    requests_and_comments as feedback,
)
from service.api.figure_renderer import Renderer
from service.auth import device_login, forms, oidc, roles
from service.auth.cookies import Secret
from service.auth.jupyterhub import Hub
from service.auth.passwords import PasswordChecker
from service.auth.rate_limit import LoginRateLimiter
from service.http import errors, middleware, openapi
from service.http.live_updates import ChangeFeed, Listener
from service.http.templating import ENVIRONMENT
from service.pages import account, api_reference, login, queue, regrades, speed_vs_accuracy
from service.pages.class_view import assignment_rules, class_pages
from service.pages.course import audit_log, first_instructor, home, imported_lines, setup
from service.pages.course import settings as course_settings
from service.pages.people import editing, extensions, listing, roster, view_as
from service.pages.rejected_forms import form_state
from service.pages.submission import overrides, own_submissions, page
from service.pages.submission import requests_and_comments as feedback_pages
from service.settings import Settings
from service.store.database import Database
from service.store.people.people import secret
from service.store.queue import overview as queue_overview
from service.store.submissions.accepting import register

log = logging.getLogger(__name__)
ROUTERS = (
    health.router,
    submissions.catalogue,
    kit.router,
    submissions.router,
    history.router,
    events.router,
    figures.router,
    feedback.router,
    device_login.router,
)
PAGES = (
    home.router,
    audit_log.router,
    own_submissions.router,
    first_instructor.router,
    setup.router,
    view_as.router,
    listing.router,
    editing.router,
    extensions.router,
    roster.router,
    course_settings.router,
    imported_lines.router,
    class_pages.router,
    assignment_rules.router,
    exports.router,
    queue.router,
    regrades.router,
    overrides.router,
    feedback_pages.router,
    speed_vs_accuracy.router,
    page.router,
    login.router,
    account.router,
    oidc.router,
    api_reference.router,
)
ENVIRONMENT.globals |= {"csrf": forms.csrf_field, "form_state": form_state}
ALLOWED = ["Authorization", "Content-Type", "Idempotency-Key", "Last-Event-ID", "Prefer"]
EXPOSED = ["ETag", "Location", "Retry-After", "X-Request-Id"]


def create_app(settings: Settings, find_loss: Callable[[], str | None] = lambda: None) -> FastAPI:
    """Return the application for a migrated database; ``find_loss`` returns the reason why the files of an
    embedded database are lost, or None.

    Raises ValueError if ``settings.database_url`` is not set.
    """
    if settings.database_url is None:
        raise ValueError(
            "create_app needs settings.database_url; polhode serve starts an embedded database for it"
        )
    app = FastAPI(
        title="polhode",
        version="1",
        lifespan=partial(_lifespan, find_loss=find_loss),
        docs_url=None,
        redoc_url=None,
    )
    app.state.held = {Settings: settings, oidc.Provider: oidc.Provider(settings)}
    errors.install(app)
    openapi.install(app)
    roles.install(app)
    if origins := settings.allowed_origins():
        methods = ["GET", "POST", "DELETE"]
        app.add_middleware(
            CORSMiddleware,
            allow_origins=origins,
            allow_methods=methods,
            allow_headers=ALLOWED,
            expose_headers=EXPOSED,
        )
    https = (settings.public_url or "").startswith("https://")
    app.add_middleware(middleware.RequestMiddleware, https=https)
    for router in ROUTERS:
        app.include_router(router)
    for router in PAGES:
        app.include_router(
            router, include_in_schema=False, dependencies=[Depends(course_settings.use_course_zone)]
        )
    files = StaticFiles(directory=Path(__file__).parent / "pages" / "static")
    # pages are not: compression can leak a form's token
    app.mount("/static", GZipMiddleware(files, compresslevel=6))
    app.include_router(home.others, include_in_schema=False)
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI, find_loss: Callable[[], str | None]) -> AsyncIterator[None]:
    settings: Settings = app.state.held[Settings]
    assert settings.database_url is not None
    async with Database(
        settings.database_url,
        "polhode web",
        connections=10,
        wait_s=settings.database_wait,
        find_loss=find_loss,
    ) as database:
        valid, invalid = load_catalogue()
        await register(database, valid.values())
        for sentence in [*invalid.values(), *course_packages.errors()]:
            log.error("%s", sentence)
        listener, renderer = Listener(database), Renderer()
        hub = Hub(settings.hub_api_url, settings.hub_service)
        checker, large_bodies = PasswordChecker(database), parse_submission.LargeBodies(settings)
        overview = ChangeFeed(
            listener,
            lambda: queue_overview.snapshot(database),
            partial(queue.snapshot, lease_s=settings.lease),
        )
        signing = Secret(await secret(database, "forms"))
        for one in (
            database,
            listener,
            renderer,
            hub,
            checker,
            large_bodies,
            overview,
            signing,
            LoginRateLimiter(),
            health.WorkerStatus(database),
        ):
            app.state.held[type(one)] = one
        listener.start()
        try:
            yield
        finally:
            renderer.stop()
            large_bodies.process.stop()
            hub.stop()
            checker.stop()
            await listener.stop()
