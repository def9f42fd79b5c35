"""Back up and restore with PostgreSQL's own programs, and check the consistency of the stored data."""

import os
import subprocess
from collections.abc import Mapping
from pathlib import Path

import psycopg
from psycopg.conninfo import conninfo_to_dict

from service.store.schema import migrate

VARIABLES = {
    "host": "PGHOST", "port": "PGPORT", "user": "PGUSER", "password": "PGPASSWORD", "dbname": "PGDATABASE",
    "options": "PGOPTIONS",
    "sslmode": "PGSSLMODE", "sslrootcert": "PGSSLROOTCERT", "sslcert": "PGSSLCERT", "sslkey": "PGSSLKEY",
    "sslcrl": "PGSSLCRL",
    "channel_binding": "PGCHANNELBINDING",
}  # fmt: skip


class BackupError(Exception):
    """The backup or restore failed; the message says why."""


def backup(url: str, programs: Path, file: Path, snapshot: str | None = None) -> None:
    """Write a consistent snapshot of the database to ``file`` while the server runs: a new one, or that of an
    open transaction.

    The file appears once it is complete. It has mode 0600, as it holds students' submissions. Raises
    BackupError.
    """
    if file.is_dir():
        raise BackupError(f"{file} is a folder: give the name of a file")
    unfinished = file.with_name(file.name + ".part")
    try:
        unfinished.touch(mode=0o600)
        same = [f"--snapshot={snapshot}"] if snapshot else []
        _run(url, programs / "pg_dump", "--format=custom", "--no-owner", f"--file={unfinished}", *same)
        unfinished.replace(file)
    finally:
        unfinished.unlink(missing_ok=True)


def check_file(file: Path) -> None:
    """Raise BackupError unless the file exists."""
    if not file.is_file():
        raise BackupError(f"there is no file {file}")


def restore(url: str, programs: Path, file: Path, *, replace: bool = False) -> None:
    """Restore ``file`` into an empty database in one transaction, and migrate it to this version.

    ``replace`` drops the present contents. Raises BackupError if the database is not empty or the restore
    fails.
    """
    check_file(file)
    name = conninfo_to_dict(url).get("dbname") or "polhode"
    with psycopg.connect(url) as connection:
        count = connection.execute("SELECT count(*) FROM pg_tables WHERE schemaname = 'public'").fetchone()
        if count and count[0] and not replace:
            raise BackupError(
                "the database is not empty: restore into a new one, or give --replace to drop its contents"
            )
        connection.execute("CREATE SCHEMA IF NOT EXISTS public")  # a damaged database may lack it
        connection.execute("DROP SCHEMA IF EXISTS replaced CASCADE")
        connection.execute("ALTER SCHEMA public RENAME TO replaced")  # renamed back if the restore fails
        connection.execute("CREATE SCHEMA public")
    options = ["--single-transaction", "--exit-on-error", "--no-owner", "--no-privileges", "--schema=public"]
    try:
        _run(url, programs / "pg_restore", *options, f"--dbname={name}", str(file))
        migrate(url)
    except BaseException:
        with psycopg.connect(url) as connection:
            connection.execute("DROP SCHEMA public CASCADE")
            connection.execute("ALTER SCHEMA replaced RENAME TO public")
        raise
    with psycopg.connect(url) as connection:
        connection.execute("DROP SCHEMA replaced CASCADE")


def check(url: str) -> Mapping[str, int]:
    """Return the number of inconsistent rows by description; all are zero in a consistent database."""
    with psycopg.connect(url) as connection:
        return {
            sentence: (connection.execute(query).fetchone() or (0,))[0] for sentence, query in _BROKEN.items()
        }


def _run(url: str, program: Path, *arguments: str) -> None:
    given = {
        VARIABLES[name]: str(value) for name, value in conninfo_to_dict(url).items() if name in VARIABLES
    }
    try:
        done = subprocess.run(
            [program, *arguments],
            env=os.environ | given,
            capture_output=True,
            text=True,
            stdin=subprocess.DEVNULL,
            check=False,
        )
    except OSError as error:
        raise BackupError(f"{program.name} cannot be run: {error}") from error
    if done.returncode != 0:
        raise BackupError(f"{program.name} failed: {done.stderr.strip()[-800:]}")


_BROKEN = {
    "submissions without a grading": (
        """
        SELECT count(*) FROM submission s WHERE NOT EXISTS (SELECT 1 FROM grading
        WHERE submission_id = s.id)"""
    ),
    "submissions whose source does not match its hash": (
        """
        SELECT count(*) FROM submission WHERE encode(sha256(convert_to(source, 'UTF8')), 'hex') <> sha256"""
    ),
    "results that are not exactly one of report and system fault": (
        """
        SELECT count(*) FROM result WHERE (report IS NULL) = (fault IS NULL)"""
    ),
    "results without the arrays they were graded from": (
        """
        SELECT count(*) FROM result r WHERE report IS NOT NULL AND NOT EXISTS (
            SELECT 1 FROM grading_artefact k WHERE k.grading_id = r.grading_id
            AND k.name IN ('arrays.npz', 'pruned'))"""
    ),
    "reports whose outcomes do not add up to their score": (
        """
        SELECT count(*) FROM result r, LATERAL (
            SELECT coalesce(sum(earned), 0) AS earned, coalesce(sum(points), 0) AS points
            FROM outcome o WHERE o.grading_id = r.grading_id AND o.counted) sums
        WHERE report IS NOT NULL AND (score, max_score) IS DISTINCT FROM (sums.earned, sums.points)"""
    ),
    "preview gradings without a regrade": "SELECT count(*) FROM grading WHERE preview AND regrade_id IS NULL",
    "artefacts whose content does not match its hash": (
        """
        SELECT count(*) FROM artefact WHERE encode(sha256(content), 'hex') <> sha256"""
    ),
    "runs that gave a result and have another end reason than finished": (
        """
        SELECT count(*) FROM result JOIN run ON run.id = result.run_id WHERE run.end_reason
        IS DISTINCT FROM 'finished'"""
    ),
    "open gradings older than a minute without a job": (
        """
        SELECT count(*) FROM grading a LEFT JOIN result r ON r.grading_id = a.id
        WHERE r.grading_id IS NULL AND a.requested_at < now() - interval '1 minute' AND NOT EXISTS (
            SELECT 1 FROM procrastinate_jobs j WHERE j.status IN ('todo', 'doing')
            AND j.args->>'attempt' = a.id::text)"""
    ),
}
