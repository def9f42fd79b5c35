"""A new assignment as a copy of the template, with another slug and title."""

import json
import keyword
import re
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

from exercises import catalogue

TEMPLATE = Path(__file__).parent / "scaffold" / "damped_oscillator"
SLUG, TITLE = "damped-oscillator", "The damped oscillator"
LONGEST, MOST_TITLE = 60, 100


class CannotScaffold(ValueError):
    """The folder cannot be created; the message says why."""


def scaffold(slug: str, title: str, into: Path) -> Path:
    """Create the folder of a new assignment within ``into``, completely or not at all, and return it.

    Raises CannotScaffold for an invalid or taken slug or title, OSError if writing fails.
    """
    _check(slug, title)
    name = slug.replace("-", "_")
    if _exists(into / name):
        raise CannotScaffold(f"{into / name} already exists")
    into.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".new-assignment-", dir=into) as made:  # hidden, so that it is not discovered
        folder = Path(made) / name
        shutil.copytree(TEMPLATE, folder, ignore=shutil.ignore_patterns("__pycache__"))
        for file, change in (("__init__.py", _declaration), ("notebook.ipynb", _notebook)):
            (folder / file).write_text(change((folder / file).read_text(encoding="utf-8"), slug, title), encoding="utf-8")
        folder.rename(into / name)
    return into / name


def _check(slug: str, title: str) -> None:
    if not re.fullmatch(r"[a-z][a-z0-9]*(-[a-z0-9]+)*", slug) or len(slug) > LONGEST:
        raise CannotScaffold(
            f"invalid slug {slug!r}: use lower-case letters and digits, with single dashes between words, such as {SLUG}"
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


def _declaration(text: str, slug: str, title: str) -> str:
    return _changed(text, {f'slug="{SLUG}"': f'slug="{slug}"', f'title="{TITLE}"': f"title={_python(title)}"})


def _notebook(text: str, slug: str, title: str) -> str:
    return json.dumps(_within(json.loads(text), slug, title), indent=1, ensure_ascii=False) + "\n"


def _within(notebook: dict[str, list[dict[str, list[str]]]], slug: str, title: str) -> object:
    """Return the notebook with the title in its heading and the slug in its setup cell."""
    changes: dict[str, Callable[[str], str]] = {
        "title": lambda line: line.replace(f"# {TITLE}", f"# {_markdown(title)}"),
        "setup": lambda line: line.replace(f'assignment="{SLUG}"', f'assignment="{slug}"'),
    }
    for cell in notebook["cells"]:
        change = changes.get(str(cell["id"]))
        if change:
            cell["source"] = [change(line) for line in cell["source"]]
    return notebook


def _changed(text: str, changes: dict[str, str]) -> str:
    for old, new in changes.items():
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def _python(title: str) -> str:
    """Return a string literal in the quotes that need fewer escapes, as the formatter writes it."""
    quote = "'" if title.count('"') > title.count("'") else '"'
    return quote + title.replace("\\", "\\\\").replace(quote, f"\\{quote}") + quote


def _markdown(title: str) -> str:
    return re.sub(r"([\\`*_{}\[\]<>#$|])", r"\\\1", title)
