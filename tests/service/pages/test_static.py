"""Style sheet and symbol font: colours that can be read, symbols that every browser can show,
and their size.
"""

import re
from pathlib import Path

import pytest
from fontTools.ttLib import TTFont

from tests.support import symbols

PAGES = Path(symbols.FILE).parents[1]
CSS = (PAGES / "static" / "polhode.css").read_text()
COMMON = "→−≤≥▸"  # in every system's fonts
COLOURS = {
    name: pair.split(", ")
    for name, pair in re.findall(r"--([a-z-]+): light-dark\((#[0-9a-f]+, #[0-9a-f]+)\)", CSS)
}
ON = {
    "words": ("ground", "card", "raised", "chosen", "passed", "failed", "slow", "broken"),
    "quiet": ("ground", "card", "raised", "chosen"),
    "link": ("ground", "card", "raised", "chosen"),
    "on-fill": ("fill",),
    "pass": ("ground", "card", "raised", "passed"),
    "fail": ("ground", "card", "raised", "failed"),
    "warn": ("ground", "card", "raised", "slow"),
    "error": ("ground", "card", "raised", "broken"),
}


def luminance(colour):
    digits = colour[1:] if len(colour) == 7 else "".join(2 * one for one in colour[1:])
    parts = [int(digits[k : k + 2], 16) / 255 for k in (0, 2, 4)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a, b):
    dark, light = sorted((luminance(a), luminance(b)))
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("scheme", [0, 1], ids=["light", "dark"])
def test_text_meets_wcag_aa_on_every_background_that_it_is_used_on(scheme):
    pairs = [(text, ground) for text, grounds in ON.items() for ground in grounds]
    low = {
        (t, g): round(c, 2) for t, g in pairs if (c := contrast(COLOURS[t][scheme], COLOURS[g][scheme])) < 4.5
    }
    assert not low
    assert contrast(COLOURS["field"][scheme], COLOURS["card"][scheme]) >= 3, "the border of a form field"


def test_every_symbol_of_the_pages_is_in_the_font_that_they_bring():
    files = [
        *PAGES.glob("templates/**/*.html"),
        *PAGES.glob("static/*.js"),
        *PAGES.parent.glob("grading/graded_file.py"),
    ]
    used = set(re.findall("[\u2190-\u2bff]", "".join(file.read_text() for file in files))) - set(COMMON)
    stored, drawn = TTFont(symbols.FILE), symbols.font()
    assert used <= set(map(chr, stored.getBestCmap())), "draw it in tests/support/symbols.py"
    (ranges,) = re.findall(r"unicode-range: ([^;]+);", CSS)
    assert (
        {int(one[2:], 16) for one in ranges.split(", ")}
        == set(stored.getBestCmap())
        == set(drawn.getBestCmap())
    )
    kept, new = (
        {name: list(f["glyf"][name].getCoordinates(f["glyf"])[0]) for name in f.getGlyphOrder()}
        for f in (stored, drawn)
    )
    assert kept == new, "python -m tests.support.symbols"


def test_every_form_that_changes_something_shows_errors_beside_its_fields():
    """By ``data-saved``, but those that another page answers,
    or that have no field and no error to correct.
    """
    answered = {"/login", "/logout", "/people/preview", "/account/revoke", "/account/logout-everywhere"}
    for template in (PAGES / "templates").glob("*.html"):
        for form in re.findall(r'<form\b[^>]*?method="post"[^\n]*', template.read_text()):
            action = re.search(r'action="([^"?]*)', form)[1]
            assert "data-saved=" in form or action in answered, f"{template.name}: {action}"
