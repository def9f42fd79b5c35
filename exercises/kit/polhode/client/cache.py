"""Assignments of a course server in a cache folder of this computer: each with its checks, its data files and
the course's own packages.

A folder holds ``made.json`` (``build``, a hash of the content, and ``server``, where it comes from),
``public.json``, ``truth.npz`` and ``plays.py`` if the assignment has local checks, ``data`` and ``course``.
"""

import contextlib
import io
import json
import os
import shutil
import tempfile
import zipfile
from pathlib import Path

from polhode.client.errors import NotebookError
from polhode.client.transport.http import call

MADE, CONNECTED = "made.json", "connected.txt"
PATIENCE_S = 5.0


class NotCached(NotebookError):
    """The cache folder cannot be written; the message says what to do."""


def folder() -> Path:
    """Return the folder of all assignments, in the user's cache folder."""
    home = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    return (Path(home) if home else Path.home() / ".cache") / "polhode" / "assignments"


def home(slug: str) -> Path:
    """Return the folder of an assignment, which may not exist."""
    return folder() / slug.replace("-", "_")


def slugs() -> list[str]:
    """Return the slugs of the assignments that are in the cache."""
    return sorted(path.parent.name.replace("_", "-") for path in folder().glob(f"*/{MADE}"))


def made(slug: str) -> dict[str, str]:
    """Return the ``build`` and the ``server`` of an assignment in the cache, nothing if it is not there."""
    try:
        found = json.loads((home(slug) / MADE).read_bytes())
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def remember(slug: str) -> None:
    """Keep which assignment a notebook has connected to last."""
    with contextlib.suppress(OSError):
        folder().mkdir(parents=True, exist_ok=True)
        (folder() / CONNECTED).write_text(slug, encoding="utf-8")


def last() -> str | None:
    """Return the assignment that a notebook has connected to last, None if there is none."""
    try:
        return (folder() / CONNECTED).read_text(encoding="utf-8").strip() or None
    except (OSError, RuntimeError, ValueError):
        return None


def fetch(server: str, slug: str) -> None:
    """Bring an assignment from ``server``, unless the same one is in the cache.

    Raises RequestError if the server does not send it, and NotCached if it cannot be stored.
    """
    known = made(slug)
    same = {"If-None-Match": f'"{known["build"]}"'} if known.get("server") == server else {}
    address = f"{server}/v1/assignments/{slug}/kit"
    answer = call("GET", address, headers={"Accept": "application/zip", **same}, patience=PATIENCE_S)
    if answer.status != 304:
        store(home(slug), answer.body, server)


def store(home: Path, archive: bytes, server: str) -> None:
    """Put what a server sent of an assignment into the folder ``home``, in place of what is there. Raises
    NotCached.
    """
    try:
        home.parent.mkdir(parents=True, exist_ok=True)
        unfinished = Path(tempfile.mkdtemp(dir=home.parent, prefix="."))
        with zipfile.ZipFile(io.BytesIO(archive)) as opened:
            opened.extractall(unfinished)
        about = json.loads((unfinished / MADE).read_bytes()) | {"server": server}
        (unfinished / MADE).write_text(json.dumps(about), encoding="utf-8")
        if home.exists():
            former = Path(tempfile.mkdtemp(dir=home.parent, prefix="."))
            home.rename(former / "former")
            shutil.rmtree(former, ignore_errors=True)
        unfinished.rename(home)
    except OSError as error:
        remedy = "set XDG_CACHE_HOME to a folder you can write to, and run this cell again."
        raise NotCached(f"The assignment cannot be stored in {home} ({error.strerror}): {remedy}") from None
