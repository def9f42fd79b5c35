"""A sandbox: one warm guest that plays jobs, replaced after many plays, after an abnormal one, and when it is
lost.
"""

import logging
import threading

from polhode.judging.outcome import Ended, SceneEnd
from service.sandbox.guest_process import GuestProcess
from service.sandbox.isolation.credentials import ROOT_ALLOWED, Identity
from service.sandbox.isolation.levels import Isolation
from service.sandbox.job import Job
from service.sandbox.result import CODES, Cancelled, OnScene, PlayResult, SystemFault, TooBusy, ignore
from service.sandbox.self_test_job import self_test_job
from service.sandbox.time_budget import DEFAULT_LIMITS, TimeBudget, TimeLimits
from service.sandbox.zygote import LibraryNeeded, Zygote, ZygoteLost

log = logging.getLogger(__name__)
MOST_PLAYS = 1000  # of one zygote
TRIES = 2


class Sandbox:
    """A sandbox with one warm guest at the given ``isolation``. ``limits`` are those of one grading.

    Without ``libraries`` a guest is warm in a fifth of the time, and imports a library when a job needs it.
    """

    def __init__(
        self,
        isolation: Isolation,
        limits: TimeLimits = DEFAULT_LIMITS,
        *,
        libraries: bool = True,
    ) -> None:
        self.isolation, self.limits, self._libraries = isolation, limits, libraries
        self._zygote: Zygote | None = None
        self._plays = 0
        self._waited_s = 0.0  # of children that have ended
        self.zygotes = 0  # started so far
        self.self_tested = False
        self.identity: Identity | None = None  # what the guest of the self-test reported
        self._turn = threading.Lock()
        self.cancelled = (
            threading.Event()
        )  # another thread sets it to end the current play; the guest stays warm

    def start(self) -> Zygote:
        """Return the guest, started now unless there is one. It may not be warm yet."""
        if self._zygote is None:
            self._plays = 0
            self.zygotes += 1
            command, environment = self.isolation.command, self.isolation.environment
            process = GuestProcess(command, environment, libraries=self._libraries)
            self._zygote = Zygote(process, self.cancelled)
        return self._zygote

    @property
    def replaced(self) -> int:
        """The number of guests that have been replaced."""
        return max(0, self.zygotes - 1)

    @property
    def waited_s(self) -> float:
        """The seconds that the guest and its children were ready to run and had no processor. Any thread may
        ask while another plays.
        """
        zygote = self._zygote
        return self._waited_s + (zygote.waited_s if zygote else 0.0)

    def wait_ready(self) -> Identity:
        """Return the guest's identity when it is warm. Raises SystemFault if it cannot start."""
        return self.start().wait_ready()

    def self_test(self) -> None:
        """Run the self-test.

        Raises SystemFault if the sandbox cannot start, if its guest has privileges, or if a forbidden
        operation succeeds.
        """
        self.identity = self.wait_ready()
        result = self.play(self_test_job())
        if result.stdout:
            raise SystemFault(
                f"the sandbox is not secure: a submission could {', '.join(result.stdout.splitlines())}"
            )
        (scene_end,) = result.scene_ends.values()
        if scene_end.ended is not Ended.MISSING:
            raise SystemFault(f"the sandbox self-test did not finish: it ended as {scene_end.ended}")
        if refusal := self.identity.refusal(self.isolation):
            raise SystemFault(refusal)
        if self.identity.is_root:
            log.warning(ROOT_ALLOWED, self.isolation.stays_root)
        self.self_tested = True

    def play(self, job: Job, on_scene: OnScene = ignore, budget: TimeBudget | None = None) -> PlayResult:
        """Play every scene of ``job`` within ``budget`` (default: a new one), after the play of another
        thread. Calls ``on_scene`` when a scene begins.

        A scene that crashes or stalls its process does not affect the others, until the budget is exceeded:
        the scenes that are left have then timed out. Raises SystemFault if the sandbox fails or the machine
        is too busy, and Cancelled if ``cancelled`` is set.
        """
        with self._turn:
            return self._play_until_done(job, on_scene, budget or TimeBudget(self.limits))

    def _play_until_done(self, job: Job, on_scene: OnScene, budget: TimeBudget) -> PlayResult:
        result = PlayResult()
        while (left := job.without(set(result.scene_ends))).scenes or not (result.loaded or job.scenes):
            left = left.without_statements(result.left_out)
            if sentence := budget.exceeded():
                if budget.delayed:
                    raise _too_busy(budget)
                for scene in left.scenes:
                    result.scene_ends[scene.name] = SceneEnd(
                        scene=scene.name,
                        ended=Ended.TIMED_OUT,
                        sentence=sentence,
                        code=CODES[Ended.TIMED_OUT],
                    )
                break
            before = len(result.scene_ends), len(result.left_out)
            self._play_once(left, budget, result, on_scene)
            if before == (len(result.scene_ends), len(result.left_out)):
                break
            self._skip_followers(job, result)
        result.scene_ends = {
            s.name: result.scene_ends[s.name] for s in job.scenes if s.name in result.scene_ends
        }
        return result

    def _play_once(self, job: Job, budget: TimeBudget, result: PlayResult, on_scene: OnScene) -> None:
        """Play the job in one child. If the zygote is lost, try again with a second one."""
        for number in range(TRIES):
            zygote = self.start()
            try:
                played, reusable = self._play_with_libraries(zygote, job, budget, on_scene)
            except ZygoteLost as lost:
                self._end_guest()
                if number == TRIES - 1:
                    raise SystemFault(str(lost)) from lost
                continue
            except Cancelled:
                raise
            except BaseException:
                self._end_guest()
                raise
            result.add(played)
            self._plays += 1
            if not reusable or self._plays >= MOST_PLAYS:
                self._end_guest()
                self.start()  # warms up while the report is written
            if _lacked_processor(job, played, budget):
                raise _too_busy(budget)
            return

    def _play_with_libraries(
        self, zygote: Zygote, job: Job, budget: TimeBudget, on_scene: OnScene
    ) -> tuple[PlayResult, bool]:
        """Play once, or again with each library that the submission turns out to need. Return the last play's
        result, and whether the zygote is reusable.

        What a zygote that was lost or lacked a library has sent is discarded.
        """
        while True:
            before = budget.waited_s
            try:
                return (played := PlayResult()), zygote.play(job, budget, played, on_scene)
            except LibraryNeeded as needed:
                zygote.import_library(needed.library)
            finally:
                self._waited_s += budget.waited_s - before

    def close(self) -> None:
        """End the guest."""
        self._end_guest()

    def _end_guest(self) -> None:
        zygote, self._zygote = self._zygote, None
        if zygote is not None:
            zygote.kill()

    def _skip_followers(self, job: Job, result: PlayResult) -> None:
        for scene in job.scenes:
            if (
                scene.name not in result.scene_ends
                and scene.after in result.scene_ends
                and not result.finished(scene.after)
            ):
                sentence = f"not run: it needs the scene {scene.after}, which did not finish"
                result.scene_ends[scene.name] = SceneEnd(
                    scene=scene.name, ended=Ended.NOT_PLAYED, sentence=sentence
                )


def _lacked_processor(job: Job, played: PlayResult, budget: TimeBudget) -> bool:
    """Return whether the process reached a limit of elapsed time because other programs used the
    processors.
    """
    budgets = [scene.budget_s for scene in job.scenes if _timed_out(played.scene_ends.get(scene.name))]
    budgets += [job.load_budget_s for cell_end in played.cells.values() if _timed_out(cell_end)]
    in_scene = budget.starved and budget.cpu_left() > 0 and played.cpu_s < max(budgets, default=0.0)
    return in_scene or (budget.delayed and bool(budgets))


def _too_busy(budget: TimeBudget) -> TooBusy:
    return TooBusy(
        f"this machine was too busy: of {budget.running_s:.0f} s, the submission waited {budget.waited_s:.0f}"
        " s for a processor; run fewer other programs on it, or fewer workers"
    )


def _timed_out(scene_end: SceneEnd | None) -> bool:
    return scene_end is not None and scene_end.ended is Ended.TIMED_OUT
