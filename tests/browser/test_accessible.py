"""Every page as axe sees it, in light and dark, wide and as a phone: nothing it objects to, nothing to push sideways."""

import pytest

from tests.support.course_pages import fill
from tests.support.database import entered

WIDTHS = (1280, 360)


@pytest.fixture(scope="module")
def paths(url, sandbox):
    return fill(url, sandbox)


@pytest.fixture(scope="module")
def server(new_server, tmp_path_factory, url, paths):
    own = {"POLHODE_DATABASE_URL": url, "POLHODE_WORKERS": "0", "POLHODE_IDENTITY": "token"}
    started = new_server(tmp_path_factory.mktemp("accessible") / "data", "/livez", **own)
    yield started
    started.stop()


@pytest.fixture(scope="module")
def axe():
    return pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not installed").Axe()


def wrong(page, axe):
    """What is wrong with the page at each width, in words."""
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 800})
        shown = page.evaluate("document.documentElement.scrollWidth")
        if shown > width:
            yield f"{page.url} is {shown} px wide at {width} px"
        if found := axe.run(page).response["violations"]:
            yield from (f"{page.url} at {width} px: {v['id']} {[n['html'][:200] for n in v['nodes'][:3]]}" for v in found)


def log_in(page, server, token):
    page.goto(f"{server.url}/login")
    page.get_by_label("The token your course gave you").fill(token)
    page.get_by_role("button", name="Log in").click()
    page.locator("nav .me").wait_for()


def test_axe_sees_what_is_wrong(page, server, axe):
    page = page()
    page.goto(f"{server.url}/login")
    page.evaluate("document.querySelector('main').innerHTML = '<p class=\"wide-one\"><img src=\"data:,\">x</p><input>'")
    page.evaluate("document.querySelector('.wide-one').style.width = '2000px'")
    told = " ".join(wrong(page, axe))
    assert "image-alt" in told and "label" in told and "px wide at 360 px" in told


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", ["prof", "tutor", "ben"])
def test_every_page(page, server, url, paths, axe, scheme, name):
    page.allowed += ["status of 404", "status of 403"]
    page = page(color_scheme=scheme, reduced_motion="reduce")
    page.goto(f"{server.url}/login?next=/people")
    found = [*wrong(page, axe)]
    log_in(page, server, entered(url, name, {"prof": "instructor", "tutor": "assistant", "ben": "student"}[name]))
    shown = {"prof": paths, "tutor": ("class", "regrade"), "ben": ("course", "given", "attempts", "account", "people")}[name]
    for what in shown:
        page.goto(server.url + paths[what])
        page.locator("button.keys").wait_for()
        found += wrong(page, axe)
    assert found == []
