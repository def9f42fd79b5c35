"""The command ``polhode worker``: grade for a server on this machine or for another database."""

import argparse

from service import logs
from service.cli.arguments import count
from service.cli.errors import CommandError
from service.cli.server.database import run_async
from service.sandbox.guest.confinement.lockdown import die_with_parent
from service.settings import Settings
from service.store.database import is_outage
from service.store.postgres.server import running_url
from service.workers.pool import WorkerPool


def add_worker(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "--slots",
        type=count,
        dest="workers",
        help="gradings at a time (POLHODE_WORKERS, default one per processor)",
    )
    parser.add_argument(
        "--with-parent", type=int, metavar="PID", help="exit when the parent process PID exits"
    )
    parser.set_defaults(run=_worker)


def _worker(arguments: argparse.Namespace) -> int:
    if arguments.with_parent is not None:
        die_with_parent(arguments.with_parent)
    settings = Settings() if arguments.workers is None else Settings(workers=arguments.workers)
    logs.install(settings.log_level)
    if settings.workers < 1:
        raise CommandError("this worker would grade nothing: set POLHODE_WORKERS or --slots to at least 1")
    url = settings.database_url or running_url(settings.data)
    if url is None:
        raise CommandError(
            f"no running server has its database in {settings.data}; start one, or set POLHODE_DATABASE_URL"
        )
    try:
        run_async(url, lambda database: database.ping())
    except (
        Exception
    ) as error:  # WrongSchema, which no retry mends; a database that does not answer yet is waited for
        if not is_outage(error):
            raise
    return WorkerPool(settings.model_copy(update={"database_url": url})).run()
