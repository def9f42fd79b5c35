"""Bytes that a submission takes in the database, before and after ``polhode db prune``.

``python -m bench.storage`` grades submissions on a server of its own, opens the figures and motions of each
report as a browser does, and measures the tables. The backup is that of ``polhode db backup``.
"""

import argparse
import asyncio
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import httpx2
import psycopg

from bench.surge import bodies, results, server

KINDS = {"exercise": "exercise 2", "notebook": "all exercises"}


def main() -> None:
    """Measure each kind of submission and print one table."""
    parser = argparse.ArgumentParser(prog="bench.storage", description=__doc__)
    parser.add_argument("--submissions", type=int, default=60, help="of each kind")
    number = parser.parse_args().submissions
    print(f"bytes per submission, mean of {number} of each kind, tables with their indexes")
    for kind, name in KINDS.items():
        measure(kind, name, number)


def measure(kind: str, name: str, number: int) -> None:
    """Print the bytes of ``number`` submissions of one kind by table, and those left after each step of
    pruning.
    """
    with server(workers=os.cpu_count() or 1) as (url, database):
        empty = sizes(database)
        addresses = asyncio.run(send(url, bodies(kind), number))
        results(database, number, time.monotonic() + 1800)
        graded = sizes(database)
        pictures = asyncio.run(look(url, addresses))
        looked = sizes(database)
        line(f"{name}: after grading", empty, graded, number)
        line(f"{name}: after {pictures / number:.1f} figures and motions were opened", empty, looked, number)
        print(f"  {name}: backup {backup(database) / number:9.0f}")
        for what, options in (
            ("prune", ["--older-than", "0"]),
            ("prune --arrays", ["--older-than", "0", "--arrays"]),
        ):
            print(prune(database, [*options, "--delete"]).rstrip())
            with psycopg.connect(database, autocommit=True) as connection:
                connection.execute("VACUUM FULL")
            line(f"{name}: after {what}", empty, sizes(database), number)
        print(f"  {name}: backup {backup(database) / number:9.0f}")


async def send(url: str, choice: list[dict[str, object]], number: int) -> list[str]:
    """Send submissions of as many persons and return their addresses."""
    async with httpx2.AsyncClient(base_url=url, timeout=60, trust_env=False) as client:
        addresses = []
        for k in range(number):
            body, headers = choice[k % len(choice)], {"Remote-User": f"s{k:04}"}
            answer = await client.post("/v1/assignments/rigid-body/submissions", json=body, headers=headers)
            addresses.append(answer.raise_for_status().headers["Location"])
        return addresses


async def look(url: str, addresses: list[str]) -> int:
    """Open the page of each submission, and every figure and motion of it; return the number of these."""
    count = 0
    async with httpx2.AsyncClient(base_url=url, timeout=120, trust_env=False) as client:
        for k, address in enumerate(addresses):
            headers = {"Remote-User": f"s{k:04}"}
            report = (await client.get(address, headers=headers)).json()["report"] or {}
            places = [f"{address}/figures/{figure['name']}.svg" for figure in report.get("figures", ())]
            page = await client.get(address.removeprefix("/v1"), headers=headers)
            places += sorted(
                {part for part in page.text.split('"') if part.endswith(".json") and "/motions/" in part}
            )
            for place in places:
                count += (await client.get(place, headers=headers)).status_code == 200
    return count


def sizes(database: str) -> dict[str, int]:
    """Return the bytes of every table with its indexes and long values."""
    query = (
        "SELECT relname, pg_total_relation_size(relid) FROM pg_stat_user_tables WHERE schemaname = 'public'"
    )
    with psycopg.connect(database, autocommit=True) as connection:
        connection.execute("CHECKPOINT")
        return dict(connection.execute(query).fetchall())


def line(what: str, before: dict[str, int], after: dict[str, int], number: int) -> None:
    """Print the growth of all tables and of the five that grew most."""
    growth = {name: after[name] - before[name] for name in after}
    largest = sorted(growth, key=growth.__getitem__, reverse=True)[:5]
    print(
        f"  {what}: {sum(growth.values()) / number:9.0f}  ("
        + ", ".join(f"{n} {growth[n] / number:.0f}" for n in largest)
        + ")"
    )


def backup(database: str) -> int:
    """Return the bytes of a backup."""
    with tempfile.TemporaryDirectory() as folder:
        command(database, ["backup", f"{folder}/b"])
        return Path(folder, "b").stat().st_size


def prune(database: str, options: list[str]) -> str:
    """Run ``polhode db prune`` and return what it printed."""
    return command(database, ["prune", *options])


def command(database: str, arguments: list[str]) -> str:
    """Run ``polhode db`` on the database and return what it printed."""
    done = [sys.executable, "-m", "service.cli", "db", *arguments]
    environment = os.environ | {"POLHODE_DATABASE_URL": database}
    return subprocess.run(done, env=environment, check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    main()
