"""Every page as axe sees it, in light and dark, wide and as a phone: nothing it objects to, nothing to push sideways."""

import pytest

from tests.support.app import App
from tests.support.axe import wrong
from tests.support.course_pages import fill
from tests.support.database import entered

pytestmark = pytest.mark.slow  # test_pages.py looks at three pages


@pytest.fixture(scope="module")
def paths(url, sandbox):
    return fill(url, sandbox)


@pytest.fixture(scope="module")
def server(url, paths):
    started = App(database_url=url)
    yield started
    started.stop()


def log_in(page, server, token):
    page.goto(f"{server.url}/login")
    page.get_by_label("Token from your course").fill(token)
    page.get_by_role("button", name="Log in").click()
    page.locator("nav .me").wait_for()


def test_axe_sees_what_is_wrong(page, server):
    page = page()
    page.goto(f"{server.url}/login")
    page.evaluate("document.querySelector('main').innerHTML = '<p class=\"wide-one\"><img src=\"data:,\">x</p><input>'")
    page.evaluate("document.querySelector('.wide-one').style.width = '2000px'")
    told = " ".join(wrong(page))
    assert "image-alt" in told and "label" in told and "px wide at 360 px" in told


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", ["prof", "tutor", "ben"])
def test_every_page(page, server, url, paths, scheme, name):
    page.allowed += ["status of 404", "status of 403"]
    page = page(color_scheme=scheme, reduced_motion="reduce")
    page.goto(f"{server.url}/login?next=/people")
    found = [*wrong(page)]
    log_in(page, server, entered(url, name, {"prof": "instructor", "tutor": "assistant", "ben": "student"}[name]))
    shown = {
        "prof": paths,
        "tutor": ("class", "students", "settings", "regrade"),
        "ben": ("course", "given", "attempts", "account", "people"),
    }[name]
    for what in shown:
        page.goto(server.url + paths[what])
        page.locator("button.keys").wait_for()
        found += wrong(page)
    assert found == []
