"""Run the server: the HTTP application, the workers, and an embedded database unless another one is set."""

import signal
import socket
import sys
from collections.abc import Callable
from types import FrameType

import uvicorn
from fastapi import FastAPI
from sqlalchemy.exc import DBAPIError

from service import logs
from service.app import create_app
from service.auth import oidc
from service.settings import Settings
from service.store.database import WrongSchema
from service.store.postgres.os_user import DatabaseUnavailable
from service.workers.supervisor import Supervisor

CLOSE_S = 2  # seconds that a stopping server leaves to open responses, such as event streams


def serve(settings: Settings) -> int:
    """Serve until interrupted. Return 2, with the reason on stderr, if the server cannot start."""
    logs.install(settings.log_level)
    supervisor = None
    signal.signal(
        signal.SIGTERM, _exit
    )  # uvicorn raises the signal again when it has stopped; unhandled, it would skip the clean-up
    try:
        oidc.provider(settings)  # fail before the database is started
        listening = open_socket(settings)
        supervisor = Supervisor(settings)
        supervisor.begin()
        server = http_server(settings.model_copy(update={"database_url": supervisor.url}), supervisor.find_loss)
        server.run(sockets=[listening])
        return 0 if server.started else 2
    except (oidc.NotInstalled, DatabaseUnavailable, WrongSchema, DBAPIError, OSError) as error:
        print(f"polhode: {getattr(error, 'orig', None) or error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 0
    finally:
        if supervisor is not None:
            supervisor.stop()


def http_server(settings: Settings, find_loss: Callable[[], str | None] = lambda: None) -> uvicorn.Server:
    """Return the HTTP server of the application, to run on a socket of ``open_socket``. ``settings.database_url``
    must be set; for ``find_loss`` see ``create_app``.
    """
    app = create_app(settings, find_loss)
    return _Server(uvicorn.Config(app, log_config=None, access_log=False, timeout_graceful_shutdown=CLOSE_S))


class _Server(uvicorn.Server):
    """A uvicorn server that notifies waiting requests before it closes their connections."""

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        assert isinstance(self.config.app, FastAPI)
        if (listener := getattr(self.config.app.state, "listener", None)) is not None:
            listener.leave()
        super().handle_exit(sig, frame)


def open_socket(settings: Settings) -> socket.socket:
    """Return a listening socket at the host and port of the settings. Raises OSError naming the address."""
    family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
    try:
        listening = socket.create_server((settings.host, settings.port), family=family)
    except OSError as error:
        raise OSError(f"{settings.host} port {settings.port}: {error.strerror or error}") from error
    listening.setsockopt(
        socket.IPPROTO_TCP, socket.TCP_NODELAY, 1
    )  # saves 40 ms per response; asyncio sets it only on sockets it opens
    return listening


def _exit(signum: int, frame: object) -> None:
    raise SystemExit(0)
