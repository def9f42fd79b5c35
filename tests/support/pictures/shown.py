"""Which version of the pages and the kit each picture of the docs shows, as a hash in docs/pictures.json."""

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path

from tests.support import author_pages
from tests.support.checkout import ROOT

KIT = (
    "exercises/kit/polhode/report/report_html.py",
    "exercises/kit/polhode/report/report_style.py",
    "exercises/rigid_body/course/ecp/style.py",
)
PAGES = ("service/pages/templates/*", "service/pages/static/*", *KIT)  # a page's lines are the kit's
OF_KIT = ("docs/notebook.png", "docs/authors/")  # a file, or a folder of them


def record(pictures: Iterable[Path], root: Path = ROOT) -> None:
    """Write that these pictures show the present version."""
    recorded = _recorded(root) | {name: present(name, root) for name in _names(pictures, root)}
    kept = {name: recorded[name] for name in sorted(recorded) if (root / name).exists()}
    _file(root).write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")


def outdated(root: Path = ROOT) -> list[str]:
    """Return the names of the pictures that do not show the present version."""
    recorded, there = _recorded(root), _names((root / "docs").rglob("*.png"), root)
    return sorted(name for name in recorded.keys() | there if recorded.get(name) != present(name, root))


def present(name: str, root: Path = ROOT) -> str:
    """Return the hash of the files that a picture shows."""
    digest = hashlib.sha256()
    for pattern in KIT if name.startswith(OF_KIT) else PAGES:
        for file in sorted(path for path in root.glob(pattern) if path.is_file()):
            content = file.read_bytes()
            digest.update(f"{file.relative_to(root)}\0{len(content)}\0".encode() + content)
    page = (root / name).with_suffix(".md")
    if name.startswith("docs/authors/") and page.exists():
        digest.update("".join(author_pages.blocks(page, "python")).encode())  # whose report it is
    return digest.hexdigest()[:16]


def _names(pictures: Iterable[Path], root: Path) -> set[str]:
    return {str(picture.relative_to(root)) for picture in pictures}


def _recorded(root: Path) -> dict[str, str]:
    file = _file(root)
    return json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}


def _file(root: Path) -> Path:
    return root / "docs/pictures.json"
