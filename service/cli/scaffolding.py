"""A new assignment as a copy of the template, with another title."""

import keyword
import re
import tempfile
from collections.abc import Mapping
from pathlib import Path

from exercises import catalogue

TEMPLATE = Path(__file__).parent / "scaffold" / catalogue.DECLARATION
TITLE = '"The pendulum"'
LONGEST, MOST_TITLE = 60, 100


class CannotScaffold(ValueError):
    """The folder cannot be created; the message says why."""


def scaffold(slug: str, title: str, into: Path) -> Path:
    """Create the folder of a new assignment within ``into`` and return it. Raises as ``created`` does."""
    text = TEMPLATE.read_text(encoding="utf-8")
    assert text.count(TITLE) == 1
    return created(slug, title, into, {catalogue.DECLARATION: text.replace(TITLE, _python(title)).encode()})


def created(slug: str, title: str, into: Path, files: Mapping[str, bytes]) -> Path:
    """Create the folder of an assignment with these ``files`` within ``into``, completely or not at all, and return it.

    Raises CannotScaffold for an invalid or taken slug or title, OSError if writing fails.
    """
    _check(slug, title)
    name = slug.replace("-", "_")
    if _exists(into / name):
        raise CannotScaffold(f"{into / name} already exists")
    into.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".new-assignment-", dir=into) as made:  # hidden, so that it is not discovered
        folder = Path(made) / name
        folder.mkdir()
        for file, content in files.items():
            (folder / file).parent.mkdir(exist_ok=True)
            (folder / file).write_bytes(content)
        folder.rename(into / name)
    return into / name


def _check(slug: str, title: str) -> None:
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", slug) or len(slug) > LONGEST:
        raise CannotScaffold(
            f"invalid slug {slug!r}: use lower-case letters and digits, with single dashes between words, such as driven-pendulum"
        )
    if keyword.iskeyword(slug):
        raise CannotScaffold(f"invalid slug {slug}: it is a Python keyword")
    if catalogue.is_taken(slug):
        raise CannotScaffold(f"the slug {slug} is taken by an assignment or module: choose another")
    if not title.strip() or not title.isprintable() or len(title) > MOST_TITLE:
        raise CannotScaffold(f"invalid title: use one line of at most {MOST_TITLE} printable characters")


def _exists(folder: Path) -> bool:
    """Return whether the folder exists, also as a broken link or as a module of that name."""
    return folder.is_symlink() or folder.exists() or folder.with_suffix(".py").exists()


def _python(title: str) -> str:
    """Return a string literal in the quotes that need fewer escapes, as the formatter writes it."""
    quote = "'" if title.count('"') > title.count("'") else '"'
    return quote + title.replace("\\", "\\\\").replace(quote, f"\\{quote}") + quote
