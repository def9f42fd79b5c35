"""The page of the API without JavaScript: it asks no other server, and what is folded opens."""

from urllib.parse import urlsplit

import pytest

from tests.support.app import App


@pytest.fixture
def server(database_url):
    started = App(database_url=database_url)
    yield started
    started.stop()


@pytest.mark.slow
def test_the_page_needs_neither_javascript_nor_another_server(page, server):
    new, asked = page(java_script_enabled=False), []
    new.on("request", lambda request: asked.append(urlsplit(request.url)))
    new.goto(server.url + "/docs")
    operation = new.locator("#submit_v1_assignments__slug__submissions_post")
    assert not operation.get_by_text("idempotency-key").is_visible()
    operation.locator("summary").click()
    operation.get_by_text("idempotency-key").wait_for()
    assert {(one.scheme, one.netloc) for one in asked if one.scheme != "data"} == {
        ("http", urlsplit(server.url).netloc)
    }
