"""For tests of pages: somebody who is logged in, reads pages, sends their forms and follows their events."""

import contextlib
import http.client
import json
import re
import socket
import threading
import time
import urllib.parse

from service.store.people import people
from tests.support.database import entered, run
from tests.support.http_client import Browser


def enter(url, **roles):
    """Enter these people."""

    async def entered(database):
        async with database.begin() as connection:
            await people.enroll(connection, [*roles.items()])

    run(url, entered)


class Visitor:
    """A person at a browser who has logged in; their ``token`` is for programs."""

    def __init__(self, server, url, name):
        self.server, self.name, self.token = server, name, entered(url, name, role=None)
        self._session = Browser(server).log_in(token=self.token).cookie("polhode_session").value

    def _ask(self, method, path, body=None, **headers):
        connection = http.client.HTTPConnection("127.0.0.1", self.server.port, timeout=60)
        given = {
            "Cookie": f"polhode_session={self._session}",
            "Accept": "text/html",
            "Origin": self.server.url,
        } | headers
        connection.request(method, path, body, given)
        return connection, connection.getresponse()

    def open(self, path):
        """Status and text of a page."""
        connection, answer = self._ask("GET", path)
        told = answer.status, answer.read().decode()
        connection.close()
        return told

    def json(self, path):
        return json.loads(self.open(path)[1])

    def send(self, path, form_of, **fields):
        """Send a form with the token of the page ``form_of``; status and where it leads, or what the page
        says went wrong.
        """
        found = re.search(r'name="csrf" value="(\w+)"', self.open(form_of)[1])
        body = urllib.parse.urlencode({"csrf": found[1] if found else "", **fields})
        connection, answer = self._ask(
            "POST", path, body, **{"Content-Type": "application/x-www-form-urlencoded"}
        )
        text = answer.read().decode()
        connection.close()
        if answer.status == 303:
            return 303, answer.headers["location"]
        detail = re.search(r'role="alert"[^>]*>(.*?)</(?:p|span)>', text, re.DOTALL)
        return answer.status, detail[1] if detail else text

    def follow(self, path, last=None):
        """A ``Following`` of these events."""
        return Following(*self._ask("GET", path, **({"Last-Event-ID": last} if last else {})))


class Following:
    """An open event stream; ``events`` are (time, id) as they come."""

    def __init__(self, connection, answer):
        assert answer.status == 200 and answer.headers["content-type"].startswith("text/event-stream"), (
            answer.status
        )
        self.events, self._connection, self._answer = [], connection, answer
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        with contextlib.suppress(OSError, http.client.HTTPException):  # closed from this side
            for line in self._answer:
                if line.startswith(b"id: "):
                    self.events.append((time.monotonic(), line[4:].decode().strip()))

    def close(self):
        self._answer.fp.raw._sock.shutdown(socket.SHUT_RDWR)
        self._reader.join(10)
        self._answer.close()
        self._connection.close()
