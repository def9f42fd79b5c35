"""A connection that a test leaves open in the database of all tests is found (``no_connection_stays`` in
tests/conftest.py).
"""

import psycopg

from tests.support.database import connections_left


def test_a_connection_that_stays_open_is_named_until_it_is_closed(postgres, database_url):
    others = connections_left(postgres.url, seconds=0.0).keys()
    with psycopg.connect(database_url, application_name="mine") as connection:
        connection.execute("SELECT 1")
        left = connections_left(
            postgres.url, others, seconds=0.5
        )  # the process that listed the others ends meanwhile
        assert [described.split(" (")[0] for described in left.values()] == ["mine"] and "SELECT 1" in str(
            left
        )
        assert not connections_left(postgres.url, others | left.keys())
    assert not connections_left(postgres.url, others)
