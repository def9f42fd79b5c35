"""Run the server: the HTTP application, the workers, and an embedded database unless another one is set."""

import argparse
import gc
import signal
import socket
import sys

import psycopg

from service import logs
from service.auth import oidc
from service.http.connections import raise_open_file_limit
from service.settings import Settings
from service.store.postgres.os_user import DatabaseUnavailable
from service.store.schema import WrongSchema
from service.workers.supervisor import Supervisor


def add_serve(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("--host", help="address to listen on (POLHODE_HOST, default 127.0.0.1)")
    parser.add_argument("--port", type=int, help="port to listen on (POLHODE_PORT, default 8000)")
    parser.set_defaults(run=_serve)


def _serve(arguments: argparse.Namespace) -> int:
    return serve(
        Settings(
            **{name: value for name in ("host", "port") if (value := getattr(arguments, name)) is not None}
        )
    )


def serve(settings: Settings) -> int:
    """Serve until interrupted. Return 2, with the reason on stderr, if the server cannot start."""
    logs.install(settings.log_level)
    raise_open_file_limit()
    supervisor = None
    # uvicorn raises the signal again when it has stopped; unhandled, it would skip the clean-up
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    try:
        oidc.provider(settings)  # fail before the database is started
        listening = open_socket(settings)
        supervisor = Supervisor(settings)
        supervisor.start()
        from service.cli.server.http_server import http_server  # takes a second, in which the database starts

        supervisor.wait_until_ready()
        settings = settings.model_copy(update={"database_url": supervisor.url})
        server = http_server(settings, supervisor.find_loss, announce=True)
        # else each full collection stops the event loop for 0.2 s to look at what the imports created
        gc.freeze()
        server.run(sockets=[listening])
        return 0 if server.started else 2
    except (oidc.NotInstalled, DatabaseUnavailable, WrongSchema, psycopg.Error, OSError) as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 0
    finally:
        if supervisor is not None:
            supervisor.stop()


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
