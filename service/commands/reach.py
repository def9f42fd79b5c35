"""Reaching the database from the command line: the one set, the embedded one that runs, or the embedded one started for this.

What talks to a database is imported when a command needs it, so that ``polhode grade`` starts without.
"""

import asyncio
import sys
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, ParamSpec, TypeVar

if TYPE_CHECKING:
    from service.settings import Settings
    from service.store.database import Database

P = ParamSpec("P")
T = TypeVar("T")


@contextmanager
def database_url(settings: "Settings", *, create: bool = False) -> Iterator[str]:
    """Where the database is, for the duration of the block. DatabaseUnavailable where there is none and none is to be made."""
    from service.store.account import DatabaseUnavailable
    from service.store.postgres import EmbeddedPostgres, running_url

    if url := settings.database_url or running_url(settings.data):
        yield url
        return
    if not create and not (settings.data / "postgres" / "PG_VERSION").exists():
        raise DatabaseUnavailable(f"there is no database in {settings.data} (POLHODE_DATA)")
    embedded = EmbeddedPostgres(settings.data, settings.postgres)
    embedded.start()
    try:
        yield embedded.url
    finally:
        embedded.stop()


def telling_why(command: Callable[P, int]) -> Callable[P, int]:
    """Exit code 2 and a sentence where the database does not do what is asked."""

    def wrapped(*args: P.args, **kwargs: P.kwargs) -> int:
        import psycopg
        from sqlalchemy.exc import DBAPIError

        from service.store.account import DatabaseUnavailable

        try:
            return command(*args, **kwargs)
        except (DatabaseUnavailable, OSError) as error:
            print(f"polhode: {error}", file=sys.stderr)
        except (psycopg.Error, DBAPIError) as error:
            cause = getattr(error, "orig", None) or error
            missing = isinstance(cause, psycopg.errors.UndefinedTable)
            first = str(cause).strip().split("\n")[0]
            print(f"polhode: {'the database has no tables yet: polhode db upgrade' if missing else first}", file=sys.stderr)
        return 2

    return wrapped


def do(url: str, action: "Callable[[Database], Awaitable[T]]") -> T:
    """What ``action`` makes of the database behind ``url``."""
    from service.store.database import Database

    async def once() -> T:
        database = Database(url, "polhode command", connections=1)
        try:
            return await action(database)
        finally:
            await database.close()

    return asyncio.run(once())
