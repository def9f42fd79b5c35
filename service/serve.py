"""Running the server: an embedded database under it unless there is another, and a clean end."""

import signal
import sys

import uvicorn

from service.app import create_app
from service.settings import Settings
from service.store.account import DatabaseUnavailable
from service.store.postgres import EmbeddedPostgres


def serve(settings: Settings) -> int:
    """Serve until interrupted; exit code 2 if the database cannot be had, with the reason on stderr."""
    database = None
    signal.signal(signal.SIGTERM, _end)  # uvicorn passes the signal on when it is done; unhandled it would skip the clean-up
    try:
        if settings.database_url is None:
            database = EmbeddedPostgres(settings.data)
            database.start()
            settings = settings.model_copy(update={"database_url": database.url})
        config = uvicorn.Config(create_app(settings), host=settings.host, port=settings.port, log_level="warning")
        server = uvicorn.Server(config)
        server.run()
        return 0 if server.started else 2
    except DatabaseUnavailable as error:
        print(f"polhode: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 0
    finally:
        if database is not None:
            database.stop()


def _end(signum: int, frame: object) -> None:
    raise SystemExit(0)
