"""What ``polhode serve`` prints when it has started."""

import re
import time

import pytest

from tests.support.database import sql


def printed(server, last):
    """The lines of the server's standard output until one begins with ``last``."""
    deadline = time.monotonic() + 60
    while not re.search(f"^{last}.*\n", text := server.out.read_text(), re.MULTILINE):
        assert time.monotonic() < deadline, text
        time.sleep(0.05)
    return text.splitlines()


def test_the_server_prints_where_it_listens_how_to_start_a_course_and_the_isolation_level(real_server):
    isolation = "polhode: workers grade at isolation level namespaces: bubblewrap, "
    listening, start, *_ = printed(real_server, isolation)  # on a slow machine "no worker is running" before
    assert listening == f"polhode: listening on {real_server.url}"
    assert re.fullmatch(
        f"polhode: for a course open {real_server.url}/start#token=[\\w-]{{43}} once: it creates the first"
        " instructor, and people log in from then on",
        start,
    )


@pytest.mark.slow
def test_a_reason_why_nothing_is_graded_is_printed(database_url, new_server, tmp_path):
    sql(database_url, "INSERT INTO worker (name, unavailable_reason) VALUES ('a', 'no Landlock')")
    no_workers = {"POLHODE_DATABASE_URL": database_url, "POLHODE_WORKERS": "0"}
    server = new_server(tmp_path / "data", path="/livez", **no_workers)
    listening, _, _ = printed(server, "polhode: submissions are not accepted: no Landlock")
    assert listening == f"polhode: listening on {server.url}"
