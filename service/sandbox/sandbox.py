"""Playing jobs: one warm guest behind some walls, replaced whenever it had to be killed."""

from service.sandbox.job import Cell, Job, Played
from service.sandbox.seen import Ending, Fault, SceneEnding, Seen
from service.sandbox.walls import Walls
from service.sandbox.zygote import Zygote


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
        while (left := job.without(set(seen.endings))).scenes:
            before = len(seen.endings)
            self.start()
            assert self._zygote is not None
            try:
                survived = self._zygote.play(left, seen)
            except BaseException:
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
