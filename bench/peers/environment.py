"""A virtual environment for each peer below ``.bench``, with pinned packages, created once."""

import subprocess
import sys
from pathlib import Path

from bench.peers.peer import clean_environment

HERE = Path(__file__).parent
INSTALL_S = 900.0


class NotInstalled(Exception):
    """A peer's environment cannot be created; the message is the last line of the output."""


def requirements(package: str) -> Path:
    """Return the peer's requirements file."""
    return HERE / f"requirements-{package}.txt"


def python_for(package: str, cache: Path) -> Path:
    """Return the interpreter of the peer's environment, which is recreated if its requirements changed.
    Raises NotInstalled.
    """
    folder, wanted = cache / package, requirements(package).read_text() + sys.version
    stamp, python = folder / "installed", folder / "bin/python"
    if not (stamp.exists() and stamp.read_text() == wanted):
        print(f"installing {package} into {folder}", file=sys.stderr, flush=True)
        _call([sys.executable, "-m", "venv", "--clear", folder], python)
        quiet = ["--quiet", "--disable-pip-version-check", "--no-input"]
        _call([python, "-m", "pip", "install", *quiet, "-r", requirements(package)], python)
        stamp.write_text(wanted)
    return python


def versions(package: str) -> dict[str, str]:
    """Return the pinned versions by package name."""
    return dict(line.split("==") for line in requirements(package).read_text().split())


def _call(words: list[str | Path], python: Path) -> None:
    environment = clean_environment(Path.home(), python.parent)
    try:
        ended = subprocess.run(
            words, env=environment, capture_output=True, text=True, timeout=INSTALL_S, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NotInstalled(str(error)) from error
    if ended.returncode:
        raise NotInstalled((ended.stderr.strip().splitlines() or ["no reason given"])[-1])
