"""Take pictures of pages in Chromium, with so few colours that they are small."""

import io
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright

COLOURS = 256
SCROLLED = """async () => {
    const height = document.documentElement.scrollHeight;
    for (let y = 0; y < height; y += 600) { scrollTo(0, y); await new Promise(r => setTimeout(r, 80)); }
    const loaded = image => image.complete || !image.checkVisibility()
        || new Promise(r => { image.onload = image.onerror = r; });
    await Promise.all([...document.images].map(loaded));
    scrollTo(0, 0);
}"""


@contextmanager
def chromium() -> Iterator[Browser]:
    """Provide a browser."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox", "--disable-gpu"]
        )
        yield browser
        browser.close()


@contextmanager
def open_page(browser: Browser, *, width: int = 1280, height: int = 900, **options: object) -> Iterator[Page]:
    """Provide a page in a context of its own, with playwright's options."""
    context = browser.new_context(
        viewport={"width": width, "height": height}, reduced_motion="reduce", locale="en-GB", **options
    )
    page = context.new_page()
    page.set_default_timeout(120_000)
    yield page
    context.close()


def log_in(page: Page, address: str, token: str) -> None:
    """Log in with a token from the course."""
    page.goto(f"{address}/login")
    page.get_by_label("Token from your course").fill(token)
    page.get_by_role("button", name="Log in").click()
    page.locator("nav .me").wait_for()


def show(page: Page, address: str) -> None:
    """Open a page and return when its figures are loaded."""
    page.goto(address)
    page.evaluate(SCROLLED)
    page.wait_for_timeout(300)


def upper_part(page: Page, last: str) -> bytes:
    """Return a picture of the page from its top to the lower edge of the element ``last``."""
    box = page.locator(last).first.bounding_box()
    clip = {"x": 0, "y": 0, "width": page.viewport_size["width"], "height": box["y"] + box["height"] + 16}
    return page.screenshot(full_page=True, clip=clip)


def save(picture: bytes, file: Path) -> Path:
    """Write a picture with few colours."""
    image = Image.open(io.BytesIO(picture)).convert("RGB")
    image.quantize(COLOURS, dither=Image.Dither.NONE).save(file, optimize=True)
    print(f"{file} {image.width} × {image.height}, {file.stat().st_size} bytes", flush=True)
    return file
