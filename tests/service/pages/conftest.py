"""Fixtures of the tests of pages: ask an application for a page as somebody, and send its forms."""

import io
import re
import urllib.error
import urllib.parse
import urllib.request
import uuid

import pytest

from tests.support.database import entered


@pytest.fixture(scope="module")
def looks(server, url):
    """Asks for a page as somebody; with fields, posts the form that the page ``at`` shows."""
    given = {}

    def look(who, path, /, at=None, files=None, **fields):
        if who not in given:
            given[who] = entered(url, who, role=None)
        headers = {"Authorization": f"Bearer {given[who]}", "Accept": "text/html"}
        body = None
        if at is not None:
            csrf = re.search(r'name="csrf" value="([0-9a-f]+)"', look(who, at)[1])
            fields = {"csrf": csrf[1] if csrf else "", **fields}
            body, headers["Content-Type"] = (
                multipart(fields, files) if files else (urllib.parse.urlencode(fields).encode(), FORM)
            )
            headers["Origin"] = server.url
        try:
            with urllib.request.urlopen(
                urllib.request.Request(server.url + path, body, headers), timeout=30
            ) as answer:
                return answer.status, answer.read().decode(), answer.headers
        except urllib.error.HTTPError as error:
            with error:
                return error.code, error.read().decode(), error.headers

    return look


FORM = "application/x-www-form-urlencoded"


def multipart(fields, files):
    boundary, parts = uuid.uuid4().hex, io.BytesIO()
    for name, value in fields.items():
        parts.write(
            f'--{boundary}\r\nContent-Disposition: form-data; name="{name}"\r\n\r\n{value}\r\n'.encode()
        )
    for name, (filename, content) in files.items():
        of = f'name="{name}"; filename="{filename}"'
        parts.write(f"--{boundary}\r\nContent-Disposition: form-data; {of}\r\n\r\n".encode())
        parts.write(content + b"\r\n")
    parts.write(f"--{boundary}--\r\n".encode())
    return parts.getvalue(), f"multipart/form-data; boundary={boundary}"
