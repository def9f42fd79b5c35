"""Texts that would like to be more than text, in every field that takes one, and whether a page in a browser
shows them as text.
"""

from service.sandbox.untrusted_text import BIDI_CONTROLS

RUNS = "window.pwned=1"
TAGS = f'"><img src=x onerror={RUNS}><svg onload={RUNS}>'
CORPUS = " ".join(
    [
        f"<script>{RUNS}</script>", f"</script><script>{RUNS}</script>", TAGS, f"javascript:{RUNS}",
        f"' onfocus={RUNS} x='",
        f'<a href="javascript:{RUNS}">here</a>', "<base href=//127.0.0.2/>",
        "<meta http-equiv=refresh content=0;url=/pwned>",
        "</title></textarea></option></select></td></table></pre>", "<style>*{display:none}</style>", "<!--",
        "]]>", "&lt;b&gt;",
        "{{ 7 * 7 }}", "=cmd()", "\u202eright\u202c \u2066to\u2069 left\u200f", "zero\u200b\u2060width",
        "\x1b[31m", "שלום 1 2",
    ]
)  # fmt: skip
SOURCE = f"""# {CORPUS!r}
#  {CORPUS}
def euler_eqs(t, w, I):
    print({CORPUS!r})
    raise type({TAGS!r}, (ValueError,), {{}})({CORPUS!r})


def named(*args):
    exec(compile("def inner(): raise ValueError({RUNS!r})\\ninner()", {TAGS!r}, "exec"))


named.__name__ = named.__qualname__ = {TAGS!r}
precession_rate = named
"""
TEXTS = {
    "name": f"ann {TAGS}",
    "full_name": f"Ann {TAGS} שרה",
    "filename": f"a{TAGS}\u202eyp.py",
    "words": CORPUS,
}
SHOWN = {  # pages on which what is told must be seen as it is, with the beginning of it
    "course": "a\"><img", "people": "Ann \"><img", "students": "Ann \"><img", "chosen": "Ann \"><img",
    "queue": "ann \"><img",
    "audit": "<script>window", "passed": "</title></textarea>", "failed": "</title></textarea>",
    "given": "<base href=",
    "changed": "<!--", "regrades": "<meta http-equiv", "applied": "<svg onload", "regrade": "ann \"><img",
    "waiting": "Ann \"><img",
}  # fmt: skip
ALIVE = (
    "script:not([src^='/static/']), base, meta[http-equiv], main style, [onerror], [onload], [onfocus],"
    " a[href^='javascript']"
)


def inert(page):
    """Assert that nothing ran and nothing of it became an element; what is shown."""
    assert page.locator("header nav").is_visible() and page.evaluate("typeof window.pwned") == "undefined", (
        page.url
    )
    assert page.locator(ALIVE).count() == 0, page.url
    assert not set(BIDI_CONTROLS) & set(page.content()), page.url
    return page.locator("body").inner_text()
