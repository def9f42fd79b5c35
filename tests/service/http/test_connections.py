"""Connections that clients hold: what they cannot do to a real server, and what others can do meanwhile."""

import contextlib
import re
import resource
import socket
import subprocess
import sys
import time

import pytest

from service.http.connections import ACCEPTED, OTHER_FILES, Connections, raise_open_file_limit
from service.settings import Settings
from tests.support.http_client import SUBMISSIONS, call, post
from tests.support.submissions import submitted

HOST = b"Host: 127.0.0.1\r\n"
FORM = b"POST /v1/logins HTTP/1.1\r\n" + HOST + b"Content-Type: application/json\r\n"
SUBMIT = b"POST " + SUBMISSIONS.encode() + b" HTTP/1.1\r\n" + HOST + b"Content-Type: application/json\r\n"
SHORT = 0.3
MOST_S = 20.0  # a connection that is still open then was never going to be closed


@pytest.fixture(scope="module")
def hurried(new_app, url):
    """A server that waits for nobody, with places for eight connections."""
    return new_app(
        database_url=url, header_timeout=SHORT, body_timeout=SHORT, connections=8, identity="local"
    )


@pytest.fixture(scope="module")
def server(new_app, url):
    return new_app(database_url=url, identity="local")


@pytest.fixture
def connected():
    """Open connections that have sent this much; all are closed at the end."""
    with contextlib.ExitStack() as stack:

        def connect(server, sent=b"", source="127.0.0.1"):
            connection = stack.enter_context(
                socket.create_connection(("127.0.0.1", server.port), MOST_S, (source, 0))
            )
            connection.sendall(sent)
            return connection

        yield connect


def rest(connection):
    """All that the server sends until it closes the connection."""
    received = b""
    with connection, contextlib.suppress(ConnectionResetError):
        while chunk := connection.recv(65536):
            received += chunk
    return received


def status(response):
    return int(response.split(b" ", 2)[1])


def closed(limit, server):
    """How many connections the limit has closed."""
    found = re.search(
        rf'^polhode_http_closed_total{{limit="{limit}"}} (.+)$',
        call(server, "/metrics")[2].decode(),
        re.MULTILINE,
    )
    return float(found[1]) if found else 0.0


def test_a_connection_without_a_request_is_closed(connected, hurried):
    before = closed("header", hurried)
    assert rest(connected(hurried)) == b""
    assert closed("header", hurried) == before + 1


def dribble(connection, data, every):
    """Send a byte at a time until the server closes; return its response and the number of bytes sent."""
    connection.settimeout(every)
    for sent in range(len(data)):
        try:
            connection.sendall(data[sent : sent + 1])
            if (chunk := connection.recv(65536)) or not chunk:
                connection.settimeout(MOST_S)
                return chunk + rest(connection), sent
        except TimeoutError:
            continue
        except OSError:
            return b"", sent
    raise AssertionError("the server took all of it")


@pytest.mark.parametrize("kept_alive", [False, True])
def test_a_header_that_trickles_is_cut_also_on_a_connection_used_before(connected, hurried, kept_alive):
    connection = connected(hurried)
    if kept_alive:
        connection.sendall(b"GET /livez HTTP/1.1\r\n" + HOST + b"\r\n")
        assert connection.recv(65536).startswith(b"HTTP/1.1 200")
    response, _ = dribble(connection, b"GET /livez HTTP/1.1\r\nX: " + b"x" * 2000, 0.02)
    assert status(response) == 408 and b"urn:polhode:problem:timed-out" in response


@pytest.mark.parametrize(
    "head", [b"Content-Length: 2000\r\n\r\n", b"Transfer-Encoding: chunked\r\n\r\n7d0\r\n"]
)
def test_a_body_that_trickles_is_cut_and_counted_as_nobodys_fault(connected, hurried, head):
    before = len(hurried.log.read_text())
    response, _ = dribble(connected(hurried, FORM + head), b" " * 2000, 0.02)
    assert status(response) == 408 and b"urn:polhode:problem:timed-out" in response
    assert "unhandled" not in hurried.log.read_text()[before:]


def test_a_body_is_cut_that_is_sent_to_a_route_which_does_not_read_it(connected, hurried):
    connection = connected(hurried, b"GET /livez HTTP/1.1\r\n" + HOST + b"Content-Length: 2000\r\n\r\n")
    response, _ = dribble(connection, b" " * 2000, 0.02)
    assert response.startswith(b"HTTP/1.1 200") and rest(connected(hurried)) == b""


@pytest.mark.slow
def test_a_large_body_over_a_slow_line_is_accepted(connected, hurried):
    """At 40 kB/s it takes four times as long as a body that trickles may."""
    body = b'{"source": "' + b"#" * 64_000 + b'"}'
    connection = connected(hurried, SUBMIT)
    connection.sendall(b"Content-Length: %d\r\nConnection: close\r\n\r\n" % len(body))
    for start in range(0, len(body), 2000):
        connection.sendall(body[start : start + 2000])
        time.sleep(4 * SHORT * 2000 / len(body))
    assert status(rest(connection)) == 202


@pytest.mark.slow
def test_a_stream_of_events_outlives_the_deadlines(connected, hurried, url):
    id, _ = submitted(url, "local")
    connection = connected(hurried, f"GET /v1/submissions/{id}/events HTTP/1.1\r\n".encode() + HOST + b"\r\n")
    connection.settimeout(4 * SHORT)
    received = b""
    with pytest.raises(TimeoutError):
        while chunk := connection.recv(65536):
            received += chunk
    assert b"event: queued" in received


def test_the_longest_waiting_connection_makes_place_for_a_new_one(connected, new_app, url):
    server = new_app(database_url=url, connections=8, identity="local")
    waiting = [connected(server, b"GET / HTTP/1.1\r\n") for _ in range(20)]
    assert call(server, "/livez")[0] == 200
    assert all(not (response := rest(connection)) or status(response) == 408 for connection in waiting[:13])
    waiting[-1].sendall(HOST + b"Connection: close\r\n\r\n")
    assert status(rest(waiting[-1])) == 200


def test_a_server_full_of_streams_says_so(connected, new_app, url):
    server, (id, _) = new_app(database_url=url, connections=8, identity="local"), submitted(url, "local")
    stream = f"GET /v1/submissions/{id}/events HTTP/1.1\r\n".encode() + HOST + b"\r\n"
    streams = [connected(server, stream) for _ in range(8)]
    assert all(connection.recv(65536).startswith(b"HTTP/1.1 200") for connection in streams)
    response = rest(connected(server))
    assert status(response) == 503 and b"Retry-After" in response


def test_one_address_has_at_most_half_of_the_places(connected, new_app, url):
    server, (id, _) = new_app(database_url=url, connections=8, identity="local"), submitted(url, "local")
    stream = f"GET /v1/submissions/{id}/events HTTP/1.1\r\n".encode() + HOST + b"\r\n"
    streams = [connected(server, stream, "127.0.0.9") for _ in range(4)]
    assert all(connection.recv(65536).startswith(b"HTTP/1.1 200") for connection in streams)
    assert status(rest(connected(server, source="127.0.0.9"))) == 503
    assert call(server, "/livez")[0] == 200


@pytest.mark.parametrize(
    "request_",
    [
        FORM + b"Content-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n",
        FORM + b"Content-Length: 2, 2\r\n\r\n{}",
        FORM + b"Content-Length: 2\r\nContent-Length: 2\r\n\r\n{}",
        FORM + b"Content-Length: +2\r\n\r\n{}",
        b"GET /livez HTTP/1.1\nHost: 127.0.0.1\n\n",
        b"GET /livez HTTP/1.1\r\nHost: 127.0.0.1\nX: y\r\n\r\n",
        b"GET /livez HTTP/1.1\r\n" + HOST + b"\n",
    ],
)
def test_a_head_that_a_proxy_may_read_differently_is_refused(connected, server, request_):
    assert status(rest(connected(server, request_))) == 400
    good = b"GET /livez HTTP/1.1\r\n" + HOST + b"\r\n"
    assert rest(connected(server, good + request_)).count(b"HTTP/1.1 400") == 1  # also as a second request


def test_ordinary_bodies_of_either_framing_are_accepted(connected, server):
    for framed in (b"Content-Length: 2\r\n\r\n{}", b"Transfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n"):
        connection = connected(server, FORM + b"Connection: close\r\n" + framed)
        assert status(rest(connection)) == 201


def test_no_response_names_the_server_software(server):
    assert "server" not in call(server, "/livez")[1]


@pytest.mark.parametrize("host", ["[::", "[1:2:3]", "a:b", "a:99999", "a b", "a@b", "127.0.0.1/x"])
def test_an_invalid_host_is_a_bad_request(server, host):
    for path in ("/", "/v1/me", "/nowhere"):
        answered, _, body = call(server, path, Host=host, Accept="text/html")
        assert answered == 400 and b"Host header" in body


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost:8000", "[::1]", "[::1]:80"])
def test_the_servers_own_hosts_are_accepted(server, host):
    assert call(server, "/v1/me", Host=host)[0] == 200


def test_a_client_that_leaves_during_an_upload_is_no_fault(connected, new_app, url):
    server = new_app(database_url=url, identity="local", log_level="info")
    connected(server, SUBMIT + b'Content-Length: 900\r\n\r\n{"source"').close()
    deadline = time.monotonic() + MOST_S
    while '"status": 499' not in (log := server.log.read_text()) and '"status": 500' not in log:
        assert time.monotonic() < deadline, log
        time.sleep(0.02)
    assert '"status": 500' not in log and "unhandled" not in log


@pytest.mark.parametrize(
    ("public_url", "sent"),
    [("https://polhode.example", True), ("http://polhode.example", False), (None, False)],
)
def test_browsers_stay_with_https_where_it_is_the_public_address(new_app, url, public_url, sent):
    server = new_app(database_url=url, public_url=public_url)
    assert ("max-age=31536000" in call(server, "/livez")[1].get("strict-transport-security", "")) is sent
    assert ("max-age=31536000" in call(server, "/v1/me")[1].get("strict-transport-security", "")) is sent


def test_the_limit_of_open_files_is_raised_and_leaves_some_for_other_uses():
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    try:
        resource.setrlimit(resource.RLIMIT_NOFILE, (1024, before[1]))
        assert Connections(Settings(connections=100_000)).most == 1024 - ACCEPTED - OTHER_FILES
        assert Connections(Settings(connections=100)).most == 100
        raise_open_file_limit()
        assert resource.getrlimit(resource.RLIMIT_NOFILE)[0] == before[1] > 1024
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)


SERVE = """
import resource
from service.cli.server.serve import serve
from service.settings import Settings
resource.setrlimit(resource.RLIMIT_NOFILE, (1024, resource.getrlimit(resource.RLIMIT_NOFILE)[1]))
print(serve(Settings(port={port})), *resource.getrlimit(resource.RLIMIT_NOFILE))
"""


@pytest.mark.slow  # a process of its own imports everything
def test_a_server_raises_its_limit_of_open_files_before_anything_else(server):
    done = subprocess.run(
        [sys.executable, "-c", SERVE.format(port=server.port)], capture_output=True, text=True, check=True
    )
    code, soft, hard = map(int, done.stdout.split())
    assert code == 2 and "Address already in use" in done.stderr and soft == hard > 1024


def test_submitting_goes_on_behind_idle_and_trickling_connections(connected, new_app, url):
    server = new_app(database_url=url, connections=100, identity="local")
    for k in range(150):
        connected(server, b"GET / HTTP/1.1\r\n" if k % 2 else FORM + b"Content-Length: 500\r\n\r\n{")
    for k in range(3):
        assert post(server, {"source": f"x = {k}"})[0] == 202
