"""The colours of a report in a notebook follow the front end's theme, and the system's where the front end
names none.
"""

import pytest

from polhode.report.report_style import fragment

pytestmark = pytest.mark.slow
LIGHT, DARK = "rgb(0, 103, 76)", "rgb(79, 209, 165)"
CONTRAST_LIGHT = "vscode-high-contrast-light vscode-high-contrast"  # as VS Code's webview has it
FRONT_ENDS = {
    "JupyterLab light": ('<body data-jp-theme-light="true">', LIGHT),
    "JupyterLab dark": ('<body data-jp-theme-light="false">', DARK),
    "VS Code light": ('<body class="vscode-light">', LIGHT),
    "VS Code dark": ('<body class="vscode-dark">', DARK),
    "VS Code dark, high contrast": ('<body class="vscode-high-contrast">', DARK),
    "VS Code light, high contrast": (f'<body class="{CONTRAST_LIGHT}">', LIGHT),
    "Colab dark": ('<html theme="dark"><body>', DARK),
    "Colab light": ('<html theme="light"><body>', LIGHT),
    "another": ("<body>", None),
}


@pytest.mark.parametrize("system", ["light", "dark"])
def test_a_report_has_the_colours_of_its_front_end(page, system):
    page = page(color_scheme=system)
    shown = fragment('<ul><li class="pass"><span class="mark">✓</span> a check</li></ul>')
    found = {}
    for name, (start, _) in FRONT_ENDS.items():
        page.set_content(f"<!doctype html>{start}{shown}")
        found[name] = page.locator(".mark").evaluate("mark => getComputedStyle(mark).color")
    of_system = DARK if system == "dark" else LIGHT
    assert found == {name: colour or of_system for name, (_, colour) in FRONT_ENDS.items()}
