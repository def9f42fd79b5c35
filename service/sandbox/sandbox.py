"""Playing jobs: one warm guest behind some walls, replaced after many plays, after an odd one and when it is lost."""

import threading
from collections.abc import Callable

from ecp.outcome import Ending, SceneEnding
from service.sandbox.isolation import Walls
from service.sandbox.job import Job
from service.sandbox.result import Fault, Seen, Stopped
from service.sandbox.self_test import probe
from service.sandbox.zygote import Zygote, ZygoteLost

MOST_PLAYS = 1000  # of one zygote
TRIES = 2


class Sandbox:
    """Plays jobs behind ``walls`` with one warm guest, started at once and replaced from time to time."""

    def __init__(self, walls: Walls) -> None:
        self.walls = walls.name
        self._walls = walls
        self._zygote: Zygote | None = None
        self._plays = 0
        self.zygotes = 0  # started so far
        self.rehearsed = False
        self.unwanted = threading.Event()  # set by another thread, it ends what is being played; the guest stays warm

    def start(self) -> None:
        """Begin warming a guest; returns before it is warm."""
        if self._zygote is None:
            self._plays = 0
            self.zygotes += 1
            self._zygote = Zygote(self._walls.command, self._walls.environment, self.unwanted)

    def wait_ready(self) -> None:
        """Return when a guest is warm; Fault if it cannot start."""
        self.start()
        assert self._zygote is not None
        self._zygote.wait_ready()

    def rehearse(self) -> None:
        """Play the probe, so that walls that cannot be put up or have a hole are known before a student comes. Fault if so."""
        seen = self.play(probe())
        if seen.stdout:
            raise Fault(f"the walls have a hole: a submission could {', '.join(seen.stdout.splitlines())}")
        if seen.endings["probe"].ending is not Ending.MISSING:
            raise Fault(f"the probe ended as {seen.endings['probe'].ending}")
        self.rehearsed = True

    def play(self, job: Job, tell: Callable[[str], None] = lambda scene: None) -> Seen:
        """Play every scene; one that kills its process or stalls costs only itself. Fault if the walls fail us.

        Stopped as soon as it is ``unwanted``. ``tell`` is called with the name of each scene that begins.
        """
        seen = Seen()
        while (left := job.without(set(seen.endings))).scenes:
            before = len(seen.endings)
            self._play_once(left, seen, tell)
            if len(seen.endings) == before:
                break
            self._skip_followers(job, seen)
        return seen

    def _play_once(self, job: Job, seen: Seen, tell: Callable[[str], None]) -> None:
        """One child's worth, with a second zygote if the first one is lost."""
        for attempt in range(TRIES):
            self.start()
            assert self._zygote is not None
            played = Seen()  # of this try alone: what a lost zygote had sent is forgotten
            try:
                sound = self._zygote.play(job, played, tell)
            except ZygoteLost as lost:
                self.close()
                if attempt == TRIES - 1:
                    raise Fault(str(lost)) from lost
                continue
            except Stopped:
                raise
            except BaseException:
                self.close()
                raise
            seen.add(played)
            self._plays += 1
            if not sound or self._plays >= MOST_PLAYS:
                self.close()
                self.start()  # warms up while the report is written
            return

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
