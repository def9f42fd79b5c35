"""Talk HTTP as a program does, or as a browser without a screen."""

import http.cookiejar
import json
import re
import urllib.error
import urllib.parse
import urllib.request

HIDDEN = re.compile(r'<input type="hidden" name="csrf" value="([0-9a-f]+)">')


SUBMISSIONS = "/v1/assignments/rigid-body/submissions"


def call(server, path, body=None, method=None, **headers):
    """Return status, headers and body of a request; headers are given with underscores."""
    given = {name.replace("_", "-"): value for name, value in headers.items()}
    request = urllib.request.Request(server.url + path, body, given, method=method)
    try:
        with urllib.request.urlopen(request, timeout=90) as answer:
            return answer.status, answer.headers, answer.read()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.headers, error.read()


def post(server, document, **headers):
    """Send a submission, as an object or as the bytes of one."""
    data = document if isinstance(document, bytes) else json.dumps(document).encode()
    return call(server, SUBMISSIONS, data, Content_Type="application/json", **headers)


class Browser:
    """A browser without a screen at ``server``, anything with a ``url``: it keeps cookies, follows redirects,
    and sends forms with the hidden fields it was shown. ``headers`` go with every request."""

    def __init__(self, server, **headers):
        self.server, self.cookies = server, http.cookiejar.CookieJar()
        self.headers = {"Accept": "text/html,*/*;q=0.8"} | {
            name.replace("_", "-"): value for name, value in headers.items()
        }
        self._opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(self.cookies))
        self.at, self.answer = "", {}  # the address it ended up at, the headers of the answer

    def open(self, path, origin=None, **fields):
        """Status and page; with fields it sends exactly these as a form."""
        body = urllib.parse.urlencode(fields).encode() if fields else None
        headers = self.headers | ({"Origin": origin or self.server.url} if fields else {})
        address = path if path.startswith("http") else self.server.url + path
        try:
            with self._opener.open(urllib.request.Request(address, body, headers), timeout=30) as answer:
                self.at, self.answer = answer.url.removeprefix(self.server.url), answer.headers
                return answer.status, answer.read().decode()
        except urllib.error.HTTPError as error:
            with error:
                self.at, self.answer = error.url.removeprefix(self.server.url), error.headers
                return error.code, error.read().decode()

    def send(self, path, page=None, origin=None, **fields):
        """Status and page after a form of ``page`` (default: the one to log in with, or the account's) was
        sent to ``path``.
        """
        shown = self.open(page or ("/login" if path in ("/login", "/logout") else "/account"))[1]
        token = HIDDEN.search(shown)
        assert token, f"no form at {page}"
        return self.open(path, origin, csrf=token[1], **fields)

    def log_in(self, **fields):
        """Log in with ``token=…`` or ``name=…, password=…``."""
        status, page = self.send("/login", **fields)
        assert status == 200, page
        return self

    def cookie(self, name):
        """The cookie of that name, None if there is none."""
        return next((cookie for cookie in self.cookies if cookie.name == name), None)
