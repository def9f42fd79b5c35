"""What the examples for CI find in place of a checkout of polhode: one whose installation is already done, by
our own.
"""

import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]


def installed(folder):
    """``folder``, in which ``make env`` has nothing left to do, and whose .venv is the one that runs us."""
    for name in ("Makefile", "pyproject.toml", "exercises/kit/pyproject.toml", "requirements/runtime.lock"):
        if not (folder / name).exists():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / name)
    (folder / ".venv").mkdir()
    (folder / ".venv/bin").symlink_to(Path(sys.prefix) / "bin")
    (folder / ".venv/runtime").touch()
    return folder
