"""Playing jobs: one warm guest behind some walls, replaced after many plays, after an odd one and when it is lost."""

import threading
from collections.abc import Callable

from ecp.outcome import Ended, SceneEnd
from service.sandbox.isolation import Isolation
from service.sandbox.job import Job
from service.sandbox.result import Cancelled, PlayResult, SystemFault
from service.sandbox.self_test import probe
from service.sandbox.zygote import Zygote, ZygoteLost

MOST_PLAYS = 1000  # of one zygote
TRIES = 2


class Sandbox:
    """Plays jobs behind ``walls`` with one warm guest, started at once and replaced from time to time."""

    def __init__(self, isolation: Isolation) -> None:
        self.isolation = isolation
        self._zygote: Zygote | None = None
        self._plays = 0
        self.zygotes = 0  # started so far
        self.self_tested = False
        self.unwanted = threading.Event()  # set by another thread, it ends what is being played; the guest stays warm

    def start(self) -> None:
        """Begin warming a guest; returns before it is warm."""
        if self._zygote is None:
            self._plays = 0
            self.zygotes += 1
            self._zygote = Zygote(self.isolation.command, self.isolation.environment, self.unwanted)

    def wait_ready(self) -> None:
        """Return when a guest is warm; Fault if it cannot start."""
        self.start()
        assert self._zygote is not None
        self._zygote.wait_ready()

    def self_test(self) -> None:
        """Play the probe, so that walls that cannot be put up or have a hole are known before a student comes. Fault if so."""
        seen = self.play(probe())
        if seen.stdout:
            raise SystemFault(f"the walls have a hole: a submission could {', '.join(seen.stdout.splitlines())}")
        if seen.scene_ends["probe"].ended is not Ended.MISSING:
            raise SystemFault(f"the probe ended as {seen.scene_ends['probe'].ended}")
        self.self_tested = True

    def play(self, job: Job, tell: Callable[[str], None] = lambda scene: None) -> PlayResult:
        """Play every scene; one that kills its process or stalls costs only itself. Fault if the walls fail us.

        Stopped as soon as it is ``unwanted``. ``tell`` is called with the name of each scene that begins.
        """
        seen = PlayResult()
        while (left := job.without(set(seen.scene_ends))).scenes:
            before = len(seen.scene_ends)
            self._play_once(left, seen, tell)
            if len(seen.scene_ends) == before:
                break
            self._skip_followers(job, seen)
        return seen

    def _play_once(self, job: Job, seen: PlayResult, tell: Callable[[str], None]) -> None:
        """One child's worth, with a second zygote if the first one is lost."""
        for attempt in range(TRIES):
            self.start()
            assert self._zygote is not None
            played = PlayResult()  # of this try alone: what a lost zygote had sent is forgotten
            try:
                sound = self._zygote.play(job, played, tell)
            except ZygoteLost as lost:
                self.close()
                if attempt == TRIES - 1:
                    raise SystemFault(str(lost)) from lost
                continue
            except Cancelled:
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

    def _skip_followers(self, job: Job, seen: PlayResult) -> None:
        for scene in job.scenes:
            if scene.name not in seen.scene_ends and scene.after in seen.scene_ends and not seen.finished(scene.after):
                sentence = f"it comes after {scene.after}"
                seen.scene_ends[scene.name] = SceneEnd(scene=scene.name, ended=Ended.NOT_PLAYED, sentence=sentence)
