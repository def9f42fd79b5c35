"""Connections that break, or that nobody gives back, are an outage that ends;
no query waits without limit.
"""

import asyncio

import psycopg
import pytest
from psycopg_pool import PoolTimeout

from service.store.database import ConnectionBroke, Database, is_outage
from tests.support.database import run, sql


def test_a_query_whose_connection_was_closed_runs_on_a_new_one(database_url):
    others = (
        "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = current_database() AND pid <>"
        " pg_backend_pid()"
    )

    async def act(database):
        await asyncio.gather(*(database.rows("SELECT pg_sleep(0.1)") for _ in range(3)))
        sql(database_url, others)
        assert await database.rows(
            "SELECT %(number)s + 1 AS next, '10:30'::time::text, 'a%%s'", {"number": 1}
        ) == [(2, "10:30:00", "a%s")]
        sql(database_url, others)
        with pytest.raises(ConnectionBroke) as raised:
            async with database.begin() as connection:
                await connection.execute("SELECT 1")
        assert is_outage(raised.value)
        async with database.begin() as connection:
            assert await connection.execute("INSERT INTO person (name) VALUES ('ann'), ('ben')") == 2
        with pytest.raises(psycopg.errors.UniqueViolation):
            async with database.begin() as connection:
                await connection.execute("INSERT INTO person (name) VALUES ('cem'), ('ann')")
        assert (
            len(
                await database.rows(
                    "SELECT name FROM person WHERE name = ANY(%(names)s)", {"names": ["ann", "ben", "cem"]}
                )
            )
            == 2
        )

    run(database_url, act)


def test_a_caller_waits_only_so_long_for_a_connection(database_url):
    async def act(_):
        async with Database(database_url, "test", connections=1, wait_s=0.1) as database:
            async with database.begin():
                with pytest.raises(PoolTimeout):
                    await database.rows("SELECT 1")
            assert await database.rows("SELECT 1 AS one") == [(1,)]

    run(database_url, act)
