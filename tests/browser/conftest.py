"""A real browser: Debian's Chromium, driven by playwright. What it says on its console as an error fails the
test.
"""

import shutil

import pytest

from tests.support.app import App
from tests.support.database import entered

ARGUMENTS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@pytest.fixture(scope="module")
def browser():
    """A Chromium for all tests of a module. While it is there this thread has a running event loop, which
    must not outlive the module: ``asyncio.run`` refuses to work beside it."""
    program = shutil.which("chromium")
    if program is None:
        pytest.skip("no chromium on this machine: apt-get install chromium")
    sync_api = pytest.importorskip(
        "playwright.sync_api", reason="playwright is not installed", exc_type=ImportError
    )
    with sync_api.sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=program, args=[*ARGUMENTS, "--no-first-run"])
        yield started
        started.close()


@pytest.fixture
def page(browser):
    """``page(color_scheme=…, width=…, reduced_motion=…, …)`` opens a page in a context of its own, with
    playwright's options.

    At the end of the test no page may have had an error of a script, an error on its console or a violation
    of its CSP, but for those whose words are in ``page.allowed``.
    """
    contexts, errors = [], []

    def opened(*, width=1280, height=900, **options):
        context = browser.new_context(viewport={"width": width, "height": height}, **options)
        contexts.append(context)
        new = context.new_page()
        new.set_default_timeout(60_000)  # one worker, and other tests beside it
        new.on("pageerror", lambda error: errors.append(f"{new.url}: {error}"))
        new.on(
            "console", lambda said: errors.append(f"{new.url}: {said.text}") if said.type == "error" else None
        )
        new.add_init_script(
            "addEventListener('securitypolicyviolation', e => console.error('CSP', e.violatedDirective,"
            " e.blockedURI))"
        )
        return new

    opened.allowed = []
    yield opened
    for context in contexts:
        context.close()
    assert not [error for error in errors if not any(words in error for words in opened.allowed)]


@pytest.fixture(scope="module")
def application(url):
    """An application without workers."""
    started = App(database_url=url)
    yield started
    started.stop()


@pytest.fixture
def seen_by(page, application, url):
    """``seen_by("ann", "student", path)`` is a page in a browser of their own, in which they have logged in,
    also without JavaScript."""

    def opened(name, role, path, *, javascript=True):
        new = page(java_script_enabled=javascript)
        new.goto(f"{application.url}{path}")
        new.get_by_label("Token from your course").fill(entered(url, name, role))
        new.get_by_role("button", name="Log in").click()
        new.locator("button.keys" if javascript else "nav .me").wait_for()
        return new

    return opened
