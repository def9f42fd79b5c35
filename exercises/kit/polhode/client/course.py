"""The server and the assignment of a notebook."""

import importlib.util
import os
import re
import sys
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from polhode.client import cache
from polhode.client.data_files import copy_data
from polhode.client.errors import NotebookError, RequestError

WORD = re.compile(r"^def (check|close)\(", re.MULTILINE)  # which validation cells of all courses call


class UnknownCourse(NotebookError):
    """The server, assignment or exercise is not known; the message says what to do."""


@dataclass(frozen=True)
class Course:
    """The server and assignment a notebook submits to. ``server`` has no trailing slash."""

    server: str | None = None
    assignment: str | None = None


_connected: list[Course] = [Course()]


def connect(server: str | None = None, assignment: str | None = None) -> None:
    """Set the server and assignment that ``check``, ``submit``, ``login`` and ``submissions`` use by default,
    and bring the assignment from the server: its checks, its data files and the course's own packages.

    They are kept in a cache folder, so that the next call works without the server. The data files are copied
    to the current folder, and those that are there already are left. The course's packages can be imported;
    one that is installed comes before them. Raises UnknownCourse if ``server`` is not an http or https
    address.
    """
    _connected[0] = Course(_address(server) if server else None, assignment)
    if assignment is None:
        return
    where = _connected[0].server or os.environ.get("POLHODE_SERVER") or cache.made(assignment).get("server")
    if where:
        try:
            cache.fetch(_address(where), assignment)
        except RequestError as error:
            kept = "the checks and files that came earlier are used" if cache.made(assignment) else ""
            print(f"{error} {f'Until then {kept}.' if kept else ''}".rstrip())
    copy_data(cache.home(assignment) / "data")
    cache.remember(assignment)
    use_packages(assignment)
    for sentence in _lacking(cache.home(assignment) / "course"):
        print(sentence)


def use_packages(assignment: str) -> None:
    """Let the course's packages that came with an assignment be imported, after all others, and no more those
    of another assignment.
    """
    root, folder = str(cache.folder()), str(cache.home(assignment) / "course")
    sys.path[:] = [path for path in sys.path if not path.startswith(root)]
    if os.path.isdir(folder):
        sys.path.append(folder)


def _lacking(folder: Path) -> Iterator[str]:
    """Yield a sentence for each installed package that hides one in ``folder`` and lacks modules or words of
    it.
    """
    for own in sorted(path for path in folder.glob("*") if (path / "__init__.py").is_file()):
        with suppress(ImportError, ValueError):
            spec = importlib.util.find_spec(own.name)
            home = Path((spec and (spec.origin or next(iter(spec.submodule_search_locations or ())))) or "")
            home = home.parent if home.suffix else home
            if spec is None or home == own:
                continue
            parts = sorted(path for path in own.glob("[!_]*.py"))
            absent = [f"{own.name}.{part.stem}" for part in parts if not _has(home, part)]
            if absent:
                yield (
                    f"The package {own.name} that is installed in {home} is not the course's: it lacks"
                    f" {', '.join(absent)}. Run %pip uninstall {own.name}, or rename the folder, and restart"
                    " the kernel."
                )


def _has(home: Path, part: Path) -> bool:
    """Return whether a package has a module, and if that has validation words, these."""
    if not (home / part.name).is_file():
        return (home / part.stem).is_dir() or any(home.glob(f"{part.stem}.*.*"))
    defined = [set(WORD.findall(path.read_text(encoding="utf-8"))) for path in (part, home / part.name)]
    return defined[0] <= defined[1]


def server(given: str | None = None, assignment: str | None = None) -> str:
    """Return the server's address without a trailing slash: given, connected, from POLHODE_SERVER, or that
    from which ``assignment`` (default: connected, else all in the cache) came.

    Raises UnknownCourse if none of them is set, or if assignments came from several servers.
    """
    if found := given or _connected[0].server or os.environ.get("POLHODE_SERVER"):
        return _address(found)
    slug = assignment or _connected[0].assignment
    origins = _origins([slug] if slug else []) or _origins(cache.slugs())
    if len(origins) == 1:
        return _address(origins.pop())
    several = f" (assignments came from {', '.join(sorted(origins))})" if origins else ""
    raise UnknownCourse(f'No server is set{several}: call polhode.connect("https://…") first.')


def assignment(given: str | None = None) -> str:
    """Return the assignment's slug: given, connected, or that of the only one in the cache. Raises
    UnknownCourse otherwise.
    """
    if found := given or _connected[0].assignment:
        return found
    if len(known := cache.slugs()) == 1:
        return known[0]
    several = f" ({', '.join(known)} are on this computer)" if known else ""
    raise UnknownCourse(
        f'No assignment is set{several}: call polhode.connect("https://…", assignment="…") first.'
    )


def _origins(slugs: Iterable[str]) -> set[str]:
    """Return the servers from which these assignments came."""
    return {found for slug in slugs if (found := cache.made(slug).get("server"))}


def _address(given: str) -> str:
    address = given.strip().rstrip("/")
    if not address.startswith(("http://", "https://")):
        raise UnknownCourse(f"{address} is not a server address: it must begin with http:// or https://")
    return address
