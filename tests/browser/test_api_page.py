"""The page of the API: every operation is there, from this server alone, and the content security policy stands."""

import json
from urllib.parse import urlsplit

import pytest

from tests.support.app import App
from tests.support.http_client import call


@pytest.fixture
def server(database_url):
    started = App(database_url=database_url)
    yield started
    started.stop()


@pytest.mark.slow
def test_the_page_shows_every_operation_and_asks_no_other_server(page, server):
    new, asked = page(), []
    new.on("request", lambda request: asked.append(urlsplit(request.url)))
    new.goto(server.url + "/docs")
    new.locator(".opblock").first.wait_for()
    document = json.loads(call(server, "/openapi.json")[2])
    assert new.locator(".opblock").count() == sum(len(methods) for methods in document["paths"].values())
    new.locator("#operations-default-submit_v1_assignments__slug__submissions_post button").first.click()
    new.get_by_text("idempotency-key").first.wait_for()
    assert len(asked) >= 5 and {(one.scheme, one.netloc) for one in asked if one.scheme != "data"} == {
        ("http", urlsplit(server.url).netloc)
    }
