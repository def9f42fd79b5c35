"""The seam: what shuts a guest in is a command that starts it. Two are real: bubblewrap's, and a bare process for tests."""

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

# Arguments: two folders to import from, the walls' name, the control socket.
BOOT = "import sys; sys.path += sys.argv[1:3]; from guest.zygote import main; main(int(sys.argv[4]), sys.argv[3])"
ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MPLBACKEND": "Agg",
    "LC_ALL": "C.UTF-8",
    "PATH": "/usr/bin:/bin",
}


@dataclass(frozen=True)
class Walls:
    """How a guest is shut in: a ``name`` for reports, and the whole command and environment that start it.

    The guest's control socket number is appended to the command.
    """

    name: str
    command: tuple[str, ...]
    environment: Mapping[str, str]


def process_walls() -> Walls:
    """Another process with resource limits and nothing else: it can read what the server can. For tests and trusted code."""
    import matplotlib

    import ecp

    here, kit = Path(__file__).parent, Path(ecp.__path__[0]).parent
    command = (sys.executable, "-I", "-B", "-c", BOOT, str(here), str(kit), "process")
    return Walls("process", command, ENVIRONMENT | {"MPLCONFIGDIR": matplotlib.get_cachedir()})
