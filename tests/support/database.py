"""For tests of what is stored: a new submission, an action on the database, a statement."""

import asyncio
import time
import uuid
from concurrent.futures import ThreadPoolExecutor

import psycopg

from exercises.authoring.assignments.catalogue import assignments
from service.auth import passwords
from service.grading.submission import Submission
from service.store.database import Database
from service.store.people import people, tokens
from service.store.submissions.accepting import register
from service.store.submissions.records import NewSubmission


def new(person="ann", source="def euler_eqs(t, w, I): return w", seed=7, **more):
    submission = Submission(source, exercises=more.get("exercises"))
    return NewSubmission(uuid.uuid4(), "rigid-body", person, submission, seed)


def run(url, action):
    """What ``action(database)`` gives, with the assignments entered."""

    async def main():
        async with Database(url, "test", connections=12) as database:
            await register(database, assignments().values())
            return await action(database)

    with ThreadPoolExecutor(1) as thread:  # where a browser is driven this one has a running event loop
        return thread.submit(lambda: asyncio.run(main())).result()


def sql(url, statement, *values):
    with psycopg.connect(url, autocommit=True) as connection:
        cursor = connection.execute(statement, values)
        return cursor.fetchall() if cursor.description else []


def connections_left(url, reported=frozenset(), seconds=5.0):
    """Descriptions, by process id, of the other connections to any database of the server that stay open for
    so long.

    Without those ``reported`` before. A closed connection is listed until its process has ended.
    """
    columns, until = "pid, application_name, datname, state, query", time.monotonic() + seconds
    # nor the connection of the query before this one, which may still be closing
    query = (
        f"SELECT {columns} FROM pg_stat_activity WHERE backend_type = 'client backend' AND query <>"
        " current_query()"
    )
    while True:
        left = {
            pid: f"{name or 'no name'} ({database}, {state}: {last:.60})"
            for pid, name, database, state, last in sql(url, query)
            if pid not in reported
        }
        if not left or time.monotonic() > until:
            return left
        time.sleep(0.02)


def jump(url, hours):
    """Leave the stored times as they are when the database's clock jumps by so many hours."""
    with psycopg.connect(url) as connection:
        connection.execute("SET session_replication_role = replica")  # what is never altered too
        for table, columns in {
            "run": ("started_at", "heartbeat_at", "scene_at", "ended_at"),
            "procrastinate_events": ("at",),
            "procrastinate_workers": ("last_heartbeat",),
            "submission": ("submitted_at",),
            "grading": ("requested_at",),
            "result": ("finished_at",),
            "worker": ("seen_at",),
            "assignment": ("due_at",),
            "extension": ("due_at",),
            "token": ("created_at", "expires_at", "used_at", "revoked_at"),
            "device_login": ("created_at", "expires_at"),
        }.items():
            changes = ", ".join(f"{c} = {c} - make_interval(hours => {hours})" for c in columns)
            connection.execute(f"UPDATE {table} SET {changes}")


def new_database(url, template):
    """The address of a new database beside that of ``url``."""
    name = f"t{uuid.uuid4().hex}"
    with psycopg.connect(url.replace("/polhode?", "/postgres?"), autocommit=True) as connection:
        connection.execute(f"CREATE DATABASE {name} TEMPLATE {template}")
    return url.replace("/polhode?", f"/{name}?")


def entered(url, name, role="student", password=None):
    """A token of somebody in the course, who has that password; with role None who is known keeps theirs."""

    async def enter(database):
        async with database.begin() as connection:
            await people.enroll(connection, [(name, role)])
            return await tokens.create(connection, name, label="test", scopes=tokens.SCOPES, seconds=1000.0)

    token = run(url, enter)
    if password:
        sql(url, "UPDATE person SET password = %s WHERE name = %s", passwords.hash_password(password), name)
    return token
