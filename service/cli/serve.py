"""Running the server: an embedded database under it unless there is another, a crew of workers beside it, and a clean end."""

import signal
import socket
import sys
from types import FrameType

import uvicorn
from fastapi import FastAPI
from sqlalchemy.exc import OperationalError

from service import logs
from service.app import create_app
from service.auth import oidc
from service.settings import Settings
from service.store.postgres.os_user import DatabaseUnavailable
from service.workers.supervisor import Supervisor

CLOSE_S = 2  # what a stopping server gives its open answers, event streams among them


def serve(settings: Settings) -> int:
    """Serve until interrupted; exit code 2 if the database cannot be had, with the reason on stderr."""
    logs.install(settings.log_level)
    keeper = None
    signal.signal(signal.SIGTERM, _end)  # uvicorn passes the signal on when it is done; unhandled it would skip the clean-up
    try:
        oidc.provider(settings)  # to fail before a database is started
        door = open_socket(settings)
        keeper = Supervisor(settings)
        keeper.begin()
        server = http_server(settings.model_copy(update={"database_url": keeper.url}))
        server.run(sockets=[door])
        return 0 if server.started else 2
    except (oidc.NotInstalled, DatabaseUnavailable, OperationalError, OSError) as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 0
    finally:
        if keeper is not None:
            keeper.stop()


def http_server(settings: Settings) -> uvicorn.Server:
    """Return the HTTP server of the application, which runs on a socket of ``open_door``; ``settings.database_url`` is set."""
    return _Server(uvicorn.Config(create_app(settings), log_config=None, access_log=False, timeout_graceful_shutdown=CLOSE_S))


class _Server(uvicorn.Server):
    """Lets those who wait have their last look before it closes their connections."""

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        assert isinstance(self.config.app, FastAPI)
        if (listener := getattr(self.config.app.state, "listener", None)) is not None:
            listener.leave()
        super().handle_exit(sig, frame)


def open_socket(settings: Settings) -> socket.socket:
    """Return a socket that listens where the settings say; OSError with the address where that fails."""
    family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
    try:
        door = socket.create_server((settings.host, settings.port), family=family)
    except OSError as error:
        raise OSError(f"{settings.host} port {settings.port}: {error.strerror or error}") from error
    door.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)  # asyncio sets it for its own sockets only: else 40 ms an answer
    return door


def _end(signum: int, frame: object) -> None:
    raise SystemExit(0)
