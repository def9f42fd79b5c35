"""Draw the pictures of the docs from a demonstration: ``python -m tests.support.pictures``, or only some,
such as ``report queue``.
"""

import argparse
import tempfile
from pathlib import Path

from tests.support.app import App
from tests.support.checkout import ROOT
from tests.support.pictures import authors, notebook, pages, shown, single
from tests.support.pictures.browser import chromium
from tests.support.pictures.demonstration import demonstration

DOCS = ROOT / "docs"
NAMES = ("pages", "report", "submission", "queue", "notebook", "authors")
OF_ONE = {"report", "submission", "notebook"}  # which show one submission, not the class


def main() -> None:
    """Draw the pictures and record what they show."""
    parser = argparse.ArgumentParser(prog="pictures", description=__doc__)
    parser.add_argument("names", nargs="*", help=f"some of {', '.join(NAMES)}; default: all")
    names = parser.parse_args().names or NAMES
    if unknown := set(names) - set(NAMES):
        parser.error(f"there is no picture {', '.join(sorted(unknown))}")
    with tempfile.TemporaryDirectory(prefix="polhode-pictures-") as name:
        shown.record(draw(Path(name), names))


def draw(folder: Path, names: list[str]) -> list[Path]:
    """Write the pictures and return their files; data of the demonstration lies in ``folder``."""
    drawn = []
    if "authors" in names:
        with chromium() as browser:
            drawn += authors.draw(browser, folder)
    if set(names) == {"authors"}:
        return drawn
    with demonstration(folder, with_class=bool(set(names) - OF_ONE)) as demo:
        server = App(database_url=demo.database)  # on which people log in
        one = {"report": single.draw_report, "submission": single.draw_submission, "queue": single.draw_queue}
        try:
            with chromium() as browser:
                if "pages" in names:
                    drawn += pages.draw(browser, server.url, demo.database, DOCS / "pages")
                for name, draw_one in one.items():
                    if name in names:
                        drawn.append(draw_one(browser, server.url, demo.database, DOCS / f"{name}.png"))
                if "notebook" in names:
                    file = DOCS / "notebook.png"
                    drawn.append(notebook.draw(browser, demo.address, folder / "notebook", file))
        finally:
            server.stop()
    return drawn


if __name__ == "__main__":
    main()
