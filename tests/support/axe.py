"""What is wrong with a page for who cannot see it or has a small screen."""

import pytest

WIDTHS = (1280, 390, 360)


def wrong(page, widths=WIDTHS):
    """Yield what axe objects to at each width, and that the page is wider than its window, in words."""
    # axe skips what is folded
    page.locator("details:not([open])").evaluate_all("all => all.forEach(one => { one.open = true })")
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not installed").Axe()
    for width in widths:
        page.set_viewport_size({"width": width, "height": 800})
        shown = page.evaluate("document.documentElement.scrollWidth")
        if shown > width:
            yield f"{page.url} is {shown} px wide at {width} px"
        if found := axe.run(page).response["violations"]:
            yield from (
                f"{page.url} at {width} px: {v['id']} {[n['html'][:200] for n in v['nodes'][:3]]}"
                for v in found
            )
