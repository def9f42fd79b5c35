"""How the kit talks HTTP, against a real server that answers by a script."""

import random
import socket
import ssl
import sys
import threading
import time
from datetime import UTC, datetime, timedelta
from email.utils import format_datetime
from types import SimpleNamespace

import pytest
import trustme

from polhode.client import errors
from polhode.client.errors import retry_after
from polhode.client.transport import http, pyodide, sockets
from polhode.client.transport.http import Event, HTTPError, Unreachable, call, events
from polhode.client.transport.sse import parse_events
from tests.support.fake_server import Scripted, browser, cuts, event, hangs_up, problem, says, streams

TOKEN = "secret-token-123456"
BEARER = {"Authorization": f"Bearer {TOKEN}"}


@pytest.fixture(autouse=True)
def no_proxies(monkeypatch):
    for name in ("http_proxy", "https_proxy", "all_proxy", "no_proxy"):
        monkeypatch.delenv(name, raising=False)
        monkeypatch.delenv(name.upper(), raising=False)


@pytest.fixture(autouse=True)
def short_pauses(monkeypatch):
    monkeypatch.setattr(http, "FIRST_PAUSE_S", 0.05)


@pytest.fixture
def pauses(monkeypatch):
    """The pauses in s between attempts. They take no time; a clock of their own goes on by their length."""
    made = []
    monkeypatch.setattr(http, "time", SimpleNamespace(monotonic=lambda: sum(made), sleep=made.append))
    return made


@pytest.fixture
def start():
    """Start scripted servers; all are stopped at the end."""
    started = []

    def one(*script, tls=None):
        started.append(Scripted(tls))
        started[-1].script += script
        return started[-1]

    yield one
    for server in started:
        server.stop()


@pytest.fixture(params=["waiting", "synchronous"])
def in_browser(request, monkeypatch):
    """The kernel of a web page, where Python can wait for promises and where it cannot."""
    for name, module in browser(waits=request.param == "waiting").items():
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setattr(sys, "platform", "emscripten")


def trouble(url, method="GET", **how):
    """The exception of a call, which never shows the token, nor anything it was raised from."""
    how = {"headers": BEARER, "patience": 0.0, "timeout": 5.0} | how
    with pytest.raises((Unreachable, HTTPError)) as caught:
        call(method, url, **how)
    assert TOKEN not in f"{caught.value} {caught.value!r} {vars(caught.value)}"
    assert caught.value.__cause__ is None
    assert caught.value.__suppress_context__ or caught.value.__context__ is None
    assert "\n" not in str(caught.value)
    assert str(caught.value).endswith(".")
    return caught.value


def closed_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


# ---- one answer


def test_an_answer_has_status_lower_case_headers_and_body_and_the_request_its_headers(start):
    server = start(says(202, {"id": "7"}, Location="/v1/submissions/7", Retry_After="1"))
    answer = call("POST", f"{server.url}/v1/x?y=1#z", body=b"{}", headers=BEARER | {"Idempotency-Key": "k"})
    assert (answer.status, answer.json(), answer.headers["location"]) == (
        202,
        {"id": "7"},
        "/v1/submissions/7",
    )
    seen = server.seen[0]
    assert (seen.method, seen.path, seen.body) == ("POST", "/v1/x?y=1", b"{}")
    assert (seen.headers["authorization"], seen.headers["idempotency-key"]) == (f"Bearer {TOKEN}", "k")
    assert seen.headers["user-agent"] == f"polhode-kit/1 python/3.{sys.version_info.minor}"
    assert seen.headers["accept"] == "application/json"


def test_a_text_is_an_answer_and_a_page_only_where_it_was_asked_for(start):
    server = start(says(200, b"ok", "text/plain"), says(200, b"<p>", "text/html"))
    assert call("GET", server.url).body == b"ok"
    assert call("GET", server.url, headers={"accept": "text/html"}).body == b"<p>"
    with pytest.raises(HTTPError, match="not JSON"):
        call("GET", server.url, headers={"accept": "text/html"}).json()


@pytest.mark.parametrize("times", [1, 2])
@pytest.mark.parametrize(
    "step",
    [says(503, b""), says(502, b"<p>", "text/html"), says(504), problem(429, "busy", "x"), hangs_up, cuts],
)
def test_what_may_pass_is_tried_again(start, step, times):
    server = start(*[step] * times, says(200, {"there": 1}))
    assert call("GET", server.url, patience=5.0).json() == {"there": 1}
    assert len(server.seen) == times + 1


def test_pauses_double_until_the_next_attempt_would_come_too_late(start, pauses):
    server = start(says(503))
    assert trouble(server.url, patience=0.6).status == 503
    assert len(server.seen) == 4  # at 0, 0.05, 0.15, 0.35 s, each up to a quarter later
    assert all(least <= pause <= 1.25 * least for least, pause in zip((0.05, 0.1, 0.2), pauses, strict=True))


@pytest.mark.parametrize("status", [400, 401, 403, 404, 405, 409, 413, 415, 422, 500])
def test_what_lasts_is_not_tried_again(start, status):
    server = start(problem(status, "some-kind", "a reason"), says())
    assert trouble(server.url, patience=60.0).status == status
    assert len(server.seen) == 1


def test_no_patience_means_one_attempt(start):
    server = start(says(503), says())
    assert trouble(server.url, patience=0.0).passing
    assert len(server.seen) == 1


def test_the_wait_that_a_server_asks_for_is_kept(start, pauses):
    server = start(problem(503, "busy", "x", Retry_After="7"), says())
    call("GET", server.url)
    assert len(pauses) == 1 and 7.0 <= pauses[0] <= 1.25 * 7.0


def test_a_wait_beyond_our_patience_is_not_begun(start, pauses):
    server = start(problem(503, "busy", "x", Retry_After="3600"))
    assert trouble(server.url, patience=60.0).wait_s == 3600.0
    assert pauses == []


def test_a_wait_is_a_number_or_a_date():
    now = datetime(2026, 5, 1, 12, 0, 0, tzinfo=UTC)
    assert retry_after("7", now) == 7.0
    assert retry_after(format_datetime(now + timedelta(seconds=9), usegmt=True), now) == 9.0
    assert retry_after(format_datetime(now - timedelta(seconds=9), usegmt=True), now) == 0.0
    for nothing in ("", "soon", "-1", "1.5", "Fri, 01 May 2026 12:00:00"):
        assert retry_after(nothing, now) is None


def test_a_post_cut_in_mid_answer_is_repeated_with_the_same_headers_and_body(start):
    server = start(cuts, hangs_up, says(202, {"id": "7"}))
    call(
        "POST",
        server.url,
        body=b'{"source": "x"}',
        headers=BEARER | {"Idempotency-Key": "one", "Content-Type": "application/json"},
    )
    assert len(server.seen) == 3
    assert server.seen[0] == server.seen[1] == server.seen[2]
    assert server.seen[0].headers["idempotency-key"] == "one"


def test_a_server_that_comes_up_later_is_found(start):
    server = start(says())
    server.stop()
    later = []
    timer = threading.Timer(0.2, lambda: later.append(_at(server.port)))
    timer.start()
    assert call("GET", server.url, patience=5.0).status == 200
    timer.join()
    later[0].server_close()


def _at(port):
    """A server at that port for one request."""
    import http.server

    class One(http.server.BaseHTTPRequestHandler):
        do_GET = says()

        def log_message(self, *_):
            pass

    server = http.server.HTTPServer(("127.0.0.1", port), One)
    server.handle_request()
    return server


def test_a_students_random_numbers_stay_the_same(start):
    server = start(says(503), says())
    random.seed(1)
    state = random.getstate()
    call("GET", server.url)
    assert random.getstate() == state


# ---- sentences


@pytest.mark.parametrize(
    ("step", "kind", "sentence"),
    [
        (problem(401, "nobody", "unknown token"), "nobody", "(unknown token): run polhode.login()"),
        (says(401, b"<p>", "text/html"), "nobody", "run polhode.login() and try again"),
        (problem(401, "revoked", "it was revoked"), "revoked", "(it was revoked): run polhode.login()"),
        (
            problem(403, "deadline-over", "it was at noon"),
            "deadline-over",
            "The deadline has passed (it was at noon)",
        ),
        (
            problem(403, "none-left", "all 3 are used"),
            "none-left",
            "You have no submissions left (all 3 are used)",
        ),
        (
            problem(429, "too-many-open", "20 of your submissions are waiting", Retry_After="10"),
            "too-many-open",
            "Nothing was submitted (20 of your submissions are waiting).",
        ),
        (problem(408, "timed-out", "it did not arrive in time"), "timed-out", "It did not arrive in time."),
        (problem(413, "too-large", "at most 256 KiB"), "too-large", "too large for the server"),
        (says(413, b"<p>", "text/html"), "too-large", "too large for the server"),
        (problem(503, "busy", "the database does not answer"), "busy", "is busy (the database does not"),
        (says(503, b"<p>", "text/html"), "busy", "is busy"),
        (says(429, b""), "busy", "is busy"),
        (problem(503, "no-walls", "none is taken: x"), "no-walls", "None is taken: x."),
        (problem(422, "bad-submission", "line 3 is wrong"), "bad-submission", "Line 3 is wrong."),
        (problem(404, "not-found", "there is no assignment x"), "not-found", "There is no assignment x."),
        (
            problem(500, "fault", "it failed", X_Request_Id="ab-1\u00e9<"),
            "fault",
            "not your mistake (request ab-1): try again",
        ),
        (says(500, b"<p>", "text/html"), "fault", "not your mistake: try again"),
        (
            says(404, b"<p>", "text/html"),
            "not-polhode",
            "There is no polhode server at http://127.0.0.1:{port}, something else",
        ),
        (
            says(404, {"detail": "Not Found"}),
            "not-polhode",
            "something else answered (404): check the address.",
        ),
        (
            says(200, b"<p>", "text/html; charset=utf-8"),
            "not-polhode",
            "answered (200, a web page, perhaps a login page)",
        ),
        (says(418, b""), "", "refused the request (418)."),
        (says(403, b"not json", "application/problem+json"), "", "refused the request (403)."),
        (says(302, b"", Location="/"), "moved", "Too many redirects"),
    ],
)
def test_refusals_in_words(start, step, kind, sentence):
    server = start(step)
    refused = trouble(server.url)
    assert isinstance(refused, HTTPError)
    assert refused.kind == kind
    assert sentence.format(port=server.port) in str(refused)


def test_a_detail_is_shown_short_printable_and_without_the_token(start):
    server = start(problem(422, "bad-submission", f"your {TOKEN} \x1b[31m\n" + "x" * 5000))
    assert "Your … " in str(trouble(server.url))
    assert len(str(trouble(server.url))) < 600
    assert "\x1b" not in str(trouble(server.url))


def test_nobody_listens():
    port = closed_port()
    unreachable = trouble(f"http://127.0.0.1:{port}")
    assert str(unreachable).startswith(f"Nothing answers at http://127.0.0.1:{port} (connection refused)")


def test_a_name_that_is_nobodys():
    assert "The name polhode.invalid was not found" in str(trouble("http://polhode.invalid/v1"))


def test_what_the_network_tells_in_words():
    import errno
    import http.client
    from urllib.error import URLError

    def words(error):
        return str(sockets.unreachable(error, "http://a.example:1/x", 3))

    assert "There is no network to http://a.example:1" in words(URLError(OSError(errno.ENETUNREACH, "x")))
    assert "proxy" in words(URLError(OSError("Tunnel connection failed: 407")))
    assert "was lost" in words(http.client.IncompleteRead(b"x"))
    assert "was lost" in words(http.client.RemoteDisconnected("x"))
    assert not sockets.unreachable(URLError(socket.gaierror(socket.EAI_NONAME, "x")), "http://a", 3).passing
    assert sockets.unreachable(URLError(socket.gaierror(socket.EAI_AGAIN, "x")), "http://a", 3).passing


def test_a_certificate_that_is_not_trusted_is_not_tried_again(start, tmp_path, monkeypatch):
    authority, context = trustme.CA(), ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    authority.issue_cert("127.0.0.1").configure_cert(context)
    server = start(says(), tls=context)
    began = time.monotonic()
    assert f"The certificate of {server.url} is not trusted" in str(trouble(server.url, patience=60.0))
    assert time.monotonic() - began < 2.0
    authority.cert_pem.write_to_path(tmp_path / "ca.pem")
    monkeypatch.setenv("SSL_CERT_FILE", str(tmp_path / "ca.pem"))
    assert call("GET", server.url).status == 200


def test_https_asked_of_a_server_without_it(start):
    server = start(says())
    assert "No secure connection" in str(trouble(server.url.replace("http:", "https:")))


def test_something_that_does_not_speak_http(start):
    server = start(lambda handler: handler.wfile.write(b"220 mail.example ESMTP\r\n\r\n"))
    assert "does not speak HTTP" in str(trouble(server.url))


def test_a_silent_server_times_out(start):
    server = start(lambda handler: time.sleep(0.4))
    assert "did not answer within 0.1 s" in str(trouble(server.url, timeout=0.1))


def test_a_dripping_server_times_out(start):
    def drips(handler):
        handler.send_response(200)
        handler.send_header("Content-Length", "1000")
        handler.end_headers()
        for _ in range(30):
            handler.wfile.write(b"x")
            time.sleep(0.05)

    server = start(drips)
    began = time.monotonic()
    assert "did not answer" in str(trouble(server.url, timeout=0.2))
    assert time.monotonic() - began < 1.0


def test_an_answer_too_long_is_not_read_to_its_end(start, monkeypatch):
    monkeypatch.setattr(sockets, "MOST_BYTES", 1000)
    server = start(says(200, b"x" * 1001))
    assert "too long" in str(trouble(server.url))


@pytest.mark.parametrize(
    "url",
    [
        "ftp://a.example/",
        "file:///etc/passwd",
        "polhode.example",
        "",
        "http://",
        "http://a b/",
        "http://a:x/",
        "http://a:0/",
    ]
    + [
        "http://a..b/",
        "http://ω.example/",
        f"https://me:{TOKEN}@a.example/",
        "http://a/\r\nX: y",
        "http://[::1",
        "javascript:1",
    ],
)
def test_what_is_no_address_is_told_at_once(url):
    assert "is not a server address" in str(trouble(url, patience=60.0))


@pytest.mark.parametrize("token", [f"{TOKEN}\nX: y", f"{TOKEN}\u00e9", f"{TOKEN}\x00"])
def test_a_token_that_cannot_be_sent_is_told_but_not_shown(token):
    assert str(trouble("http://a.invalid", headers={"Authorization": f"Bearer {token}"})).startswith(
        "Your token has a character"
    )


def test_white_space_around_a_token_does_no_harm(start):
    server = start(says())
    call("GET", server.url, headers={"authorization": f"Bearer {TOKEN}\n"})
    assert server.seen[0].headers["authorization"] == f"Bearer {TOKEN}"


def test_a_refusal_is_heard_before_all_is_sent(start):
    server = start(problem(413, "too-large", "at most 256 KiB"))
    assert trouble(server.url, "POST", body=b"x" * 2**24).kind == "too-large"


# ---- redirects and proxies


def test_a_redirect_within_the_server_is_followed_with_method_body_and_token(start):
    server = start(says(308, b"", Location="/there/"), says(303, b"", Location="/result"), says())
    call("POST", f"{server.url}/here", body=b"x", headers=BEARER)
    assert [(s.method, s.path, s.body) for s in server.seen] == [
        ("POST", "/here", b"x"),
        ("POST", "/there/", b"x"),
        ("GET", "/result", b""),
    ]
    assert {s.headers["authorization"] for s in server.seen} == {f"Bearer {TOKEN}"}


@pytest.mark.parametrize("status", [301, 302, 303, 307, 308])
def test_a_redirect_to_another_host_is_not_followed(start, status):
    other = start(says())
    server = start(says(status, b"", Location=f"{other.url}/x?y"))
    assert f"redirects to {other.url}:" in str(trouble(server.url))
    assert other.seen == []


def test_a_redirect_to_another_scheme_or_nowhere_is_not_followed(start):
    server = start(
        says(302, b"", Location="file:///etc/passwd"),
        says(302, b"", Location=f"https://127.0.0.1:{closed_port()}/"),
    )
    assert "is not a server address" in str(trouble(server.url))
    assert "redirects to https://127.0.0.1" in str(trouble(server.url))


def test_a_proxy_of_the_environment_is_used_but_not_for_loopback(start, monkeypatch):
    proxy, server = start(says(200, {"by": "proxy"})), start(says(200, {"by": "server"}))
    monkeypatch.setenv("http_proxy", proxy.url)
    assert call("GET", "http://polhode.invalid/v1").json() == {"by": "proxy"}
    assert proxy.seen[0].path == "http://polhode.invalid/v1"
    assert call("GET", server.url).json() == {"by": "server"}
    assert call("GET", server.url.replace("127.0.0.1", "localhost")).json() == {"by": "server"}


# ---- events


def follow(server, **how):
    return list(
        events(
            f"{server.url}/v1/submissions/7/events",
            **({"headers": BEARER, "patience": 2.0, "pause": 0.02} | how),
        )
    )


def test_a_stream_is_told_as_it_comes(start):
    parts = (
        b": hello\n\n",
        event("queued", "q 1", position=1),
        0.1,
        event("running", "r 1", scene=1),
        event("graded", "g", score=3.0),
    )
    server = start(streams(*parts, 5.0))
    told = events(f"{server.url}/v1/submissions/7/events", headers=BEARER)
    assert next(told) == Event("queued", "q 1", {"status": "queued", "position": 1})
    assert [e.name for e in told] == ["running", "graded"]
    assert len(server.seen) == 1
    assert server.seen[0].headers["accept"] == "text/event-stream"
    assert server.seen[0].headers["authorization"] == f"Bearer {TOKEN}"
    assert "last-event-id" not in server.seen[0].headers


def test_a_lost_stream_is_resumed_after_its_last_event(start):
    half = b"event: running\nid: r 2\nda"
    server = start(
        streams(event("queued", "q 1"), event("running", "r 1"), half),
        says(200, {"status": "running"}),
        hangs_up,
        says(200, {"status": "running"}),
        streams(event("running", "r 2", scene=2)),
        says(200, {"status": "running"}),
        streams(event("faulted", "f")),
    )
    assert [e.id for e in follow(server)] == ["q 1", "r 1", "r 2", "f"]
    assert [s.path.rpartition("/")[2] for s in server.seen] == ["events", "7"] * 3 + ["events"]
    assert [s.headers.get("last-event-id") for s in server.seen][::2] == [None, "r 1", "r 1", "r 2"]
    assert {s.headers["authorization"] for s in server.seen} == {f"Bearer {TOKEN}"}


def test_a_result_that_comes_while_the_stream_is_lost_is_found_by_asking(start):
    server = start(streams(event("running", "r 1")), says(200, {"status": "graded", "report": {}}))
    assert follow(server) == [
        Event("running", "r 1", {"status": "running"}),
        Event("graded", "", {"status": "graded"}),
    ]


def test_a_silent_stream_falls_back_to_asking_once_and_goes_on(start):
    server = start(
        streams(1.0),
        says(200, {"status": "queued"}),
        streams(event("running", "r"), 1.0),
        says(200, {"status": "running"}),
        streams(event("graded", "g")),
    )
    began = time.monotonic()
    assert [(e.name, e.id) for e in follow(server, silence=0.15)] == [
        ("queued", ""),
        ("running", "r"),
        ("graded", "g"),
    ]
    assert 0.3 <= time.monotonic() - began < 0.9


def test_comments_keep_a_stream_alive(start):
    server = start(streams(*[b": ping\n\n", 0.1] * 4, event("graded", "g")))
    assert [e.id for e in follow(server, silence=0.3)] == ["g"]
    assert len(server.seen) == 1


def test_a_server_that_restarts_meanwhile_is_waited_for(start):
    server = start(
        streams(event("queued", "q")),
        says(503),
        hangs_up,
        says(200, {"status": "queued"}),
        streams(event("graded", "g")),
    )
    assert [e.name for e in follow(server)] == ["queued", "graded"]


def test_a_name_lost_with_the_network_is_waited_for_once_the_server_was_there(monkeypatch):
    lost, there = Unreachable("x", passing=False), errors.Answer(200, {}, b'{"status": "queued"}')
    steps = [there, lost, errors.Answer(200, {}, b'{"status": "graded"}')]

    class Flaky:
        def request(self, *_):
            step = steps.pop(0)
            if isinstance(step, Exception):
                raise step
            return step

        def stream(self, *_):
            return ()

    monkeypatch.setattr("polhode.client.transport.http._backend", Flaky)
    assert [e.name for e in events("http://a.example/v1/submissions/7/events", pause=0.01)] == [
        "queued",
        "graded",
    ]


def test_a_submission_that_is_not_there_ends_the_following(start):
    server = start(problem(404, "not-found", "there is no submission 7"))
    with pytest.raises(HTTPError, match=r"There is no submission 7\."):
        follow(server)
    assert len(server.seen) == 2


def test_a_lost_server_ends_the_following_after_our_patience(start):
    server = start(streams(event("queued", "q")), hangs_up)
    with pytest.raises(Unreachable, match="was lost"):
        follow(server, patience=0.2)


def test_a_document_without_status_is_not_polhodes(start):
    server = start(says(200, {"hello": 1}))
    with pytest.raises(HTTPError, match="no polhode server"):
        follow(server)


def test_a_stream_left_alone_is_closed(start):
    gone = threading.Event()

    def endless(handler):
        streams(event("queued", "q"))(handler)
        try:
            while True:
                handler.wfile.write(b": ping\n\n")
                time.sleep(0.01)
        except OSError:
            gone.set()

    told = events(f"{start(endless).url}/v1/submissions/7/events")
    next(told)
    told.close()
    assert gone.wait(2.0)


def test_events_in_any_pieces_are_the_same_events():
    first = b': x\r\n\r\nevent: a\r\nid: 1\r\ndata: {"k":\r\ndata: 1}\r\n\r\n'
    text = first + b'data: [1]\n\ndata: no\n\nid: \xc3\xa9\ndata: {"k": "\xc3\xa9"}\n\ndata: {}'
    whole = [Event("a", "1", {"k": 1}), Event("message", "", {"k": "é"})]
    for size in (1, 2, 7, len(text)):
        assert list(parse_events(text[i : i + size] for i in range(0, len(text), size))) == whole
    assert list(parse_events([b"x" * 2**20, b"y", b"\n\ndata: {}\n\n"])) == []


# ---- in a browser


@pytest.mark.usefixtures("in_browser")
class TestInABrowser:
    def test_a_post_goes_and_comes_whole_without_a_user_agent(self, start):
        server = start(cuts, says(202, b'{"id": "\xc3\xa9"}', Location="/v1/submissions/7"))
        answer = call(
            "POST", server.url, body=b"\x00\xff", headers=BEARER | {"Idempotency-Key": "k"}, patience=5.0
        )
        assert (answer.status, answer.json(), answer.headers["location"]) == (
            202,
            {"id": "é"},
            "/v1/submissions/7",
        )
        assert server.seen[0] == server.seen[1]
        assert (server.seen[0].method, server.seen[0].body) == ("POST", b"\x00\xff")
        assert server.seen[0].headers["authorization"] == f"Bearer {TOKEN}"
        assert "polhode" not in server.seen[0].headers["user-agent"]  # the double's own

    def test_refusals_are_the_same(self, start):
        server = start(problem(403, "deadline-over", "it was at noon"))
        assert "The deadline has passed (it was at noon)" in str(trouble(server.url))

    def test_who_is_not_reached_is_told_with_what_may_be_wrong(self):
        assert "Your browser did not reach http://127.0.0.1" in str(
            trouble(f"http://127.0.0.1:{closed_port()}/")
        )

    def test_a_silent_server_times_out(self, start):
        server = start(lambda handler: time.sleep(0.3))
        assert "did not answer within 0.1 s" in str(trouble(server.url, timeout=0.1))

    def test_a_redirect_within_the_server_is_followed(self, start):
        server = start(says(307, b"", Location="/there"), says(200, {"k": 1}))
        assert call("GET", server.url).json() == {"k": 1}

    def test_what_another_host_answers_after_a_redirect_is_not_taken(self, start):
        other = start(says())
        server = start(says(307, b"", Location=f"{other.url}/x"))
        assert f"redirects to {other.url}:" in str(trouble(server.url))
        assert "authorization" not in other.seen[0].headers

    def test_an_answer_too_long_is_refused(self, start, monkeypatch):
        monkeypatch.setattr(pyodide, "MOST_BYTES", 1000)
        assert "too long" in str(trouble(start(says(200, b"x" * 1001)).url))

    def test_a_submission_is_followed_by_asking(self, start):
        server = start(
            *[says(200, {"status": s}) for s in ("queued", "queued", "running", "running", "graded")]
        )
        assert follow(server) == [Event(s, "", {"status": s}) for s in ("queued", "running", "graded")]
        assert {s.path for s in server.seen} == {"/v1/submissions/7"}


def test_an_old_pyodide_has_no_promises_to_wait_for(monkeypatch):
    modules = browser(waits=False)
    del modules["pyodide.ffi"].can_run_sync
    for name, module in modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    assert not pyodide._can_wait()
