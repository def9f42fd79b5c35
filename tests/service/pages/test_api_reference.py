"""The page of the API: all of the OpenAPI document is there, and its commands are requests that the server
understands.
"""

import json
import re
import shlex
from html import unescape

import pytest

from service.http.openapi import JSON
from service.pages.api_reference import fields, type_of
from tests.support.database import entered
from tests.support.http_client import call


@pytest.fixture(scope="module")
def server(new_app, url):
    return new_app(database_url=url)


@pytest.fixture(scope="module")
def document(server):
    return json.loads(call(server, "/openapi.json")[2])


@pytest.fixture(scope="module")
def page(server):
    status, headers, body = call(server, "/docs", Accept="text/html")
    assert status == 200 and headers["content-type"].startswith("text/html")
    return body.decode()


def test_every_operation_has_its_parameters_fields_and_errors(document, page):
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            article = page.partition(f'id="{operation["operationId"]}"')[2].partition("</article>")[0]
            assert f"<b>{method.upper()}</b> {path}</code>" in article
            assert ("Needs a login" in article) is ("security" in operation)
            for parameter in operation.get("parameters", ()):
                assert f"<code>{parameter['name']}</code></th><td>{parameter['in']}</td>" in article
            for media, content in operation.get("requestBody", {}).get("content", {}).items():
                assert media in article
                reference = content["schema"].get("$ref", "").rpartition("/")[2]
                for name in document["components"]["schemas"].get(reference, content["schema"])["properties"]:
                    assert f"<code>{name}</code></th>" in article, (path, name)
            for status, response in operation["responses"].items():
                assert f"<b>{status}</b>" in article, (path, status)
                for media in response.get("content", {}) if status < "4" else ():
                    assert media in article
    for name, schema in document["components"]["schemas"].items():
        shown = page.partition(f'<details class="card" id="{name}">')[2].partition("</details>")[0]
        if name.startswith("Body_"):
            continue  # shown with its request
        assert all(f"<code>{field}</code></th>" in shown for field in schema.get("properties", ())), name
        assert all(f"<code>{value}</code>" in shown for value in schema.get("enum", ())), name


def test_every_link_within_the_page_leads_somewhere(page):
    links, ids = set(re.findall(r'href="#([^"]+)"', page)), set(re.findall(r'id="([^"]+)"', page))
    assert len(links) > 30 and {unescape(link).replace("%20", " ") for link in links} <= ids


def test_the_commands_are_requests_that_the_server_understands(server, document, page, url):
    """Words in capitals name no submission here, so a request may fail, but not because of its route, method
    or body.
    """
    token = f"Bearer {entered(url, 'ann')}"
    commands = [shlex.split(unescape(one)) for one in re.findall(r">(curl [^<]+)</pre>", page)]
    assert len(commands) == sum(map(len, document["paths"].values()))
    for command in commands:
        method = command[command.index("-X") + 1] if "-X" in command else "GET"
        if method == "DELETE" and command[-1].endswith("/token"):
            continue  # it would revoke the token of the others
        headers = {"Authorization": token} if "Authorization: Bearer $TOKEN" in command else {}
        body = command[command.index("-d") + 1].encode() if "-d" in command else None
        headers |= {"Content_Type": JSON} if body else {}
        path = command[-1].removeprefix(server.url).replace("SLUG", "rigid-body")
        status, _, answer = call(server, path, body, method, **headers)
        assert status not in (401, 405, 415, 500), (command, answer)
        assert status != 422 or "FORM" in command[-1] or "/answer" in path, (command, answer)


@pytest.mark.parametrize(
    ("schema", "shown"),
    [
        ({"$ref": "#/components/schemas/Outcome"}, '<a href="#Outcome">Outcome</a>'),
        ({"type": "array", "items": {"type": "string"}, "minItems": 1}, "list of string, at least 1"),
        ({"anyOf": [{"type": "integer", "minimum": 2}, {"type": "null"}]}, "integer, from 2 or null"),
        ({"enum": ["a<b", "c"], "type": "string"}, "<code>a&lt;b</code> or <code>c</code>"),
        ({"type": "object", "additionalProperties": {"type": "number"}}, "object with values number"),
        ({"type": "string", "default": "x"}, "string, default <code>&#34;x&#34;</code>"),
        ({}, "any"),
    ],
)
def test_a_type_in_words(schema, shown):
    assert type_of(schema) == shown
    assert fields({"properties": {"a": schema}, "required": ["a"]})[0].required
