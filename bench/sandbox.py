"""Cost of the sandbox: a warm child against a cold bwrap and Python per submission; rates, memory, kill
latency.

The goals hold for an idle machine with two cores.
"""

import os
import statistics
import subprocess
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from exercises.authoring.assignments.assignment import ArraySpec
from exercises.authoring.assignments.catalogue import find
from service.grading.sandbox_job import draw_inputs, job_of
from service.grading.submission import Submission
from service.sandbox import session
from service.sandbox.guest.wire import CLOCK_FACTOR
from service.sandbox.isolation.levels import process_isolation
from service.sandbox.isolation.select import choose
from service.sandbox.job import Cell, Job, SceneRequest
from service.sandbox.sandbox import Sandbox

RIGHT = """
def euler_eqs(t, w, I):
    I1, I2, I3 = I
    return np.array(
        [(I2 - I3) * w[1] * w[2] / I1, (I3 - I1) * w[2] * w[0] / I2, (I1 - I2) * w[0] * w[1] / I3]
    )
"""
TRIVIAL = Job(
    "import numpy as np",
    "def ask(student, inputs):\n    return {'x': student['np'].array(student['f'](1.0))}",
    (
        Cell(
            "submission.py",
            "import time\nprint(time.clock_gettime(time.CLOCK_MONOTONIC))\ndef f(x):\n    return [x, x]",
        ),
    ),
    ("f",),
    (SceneRequest("one", "ask", "f", {}, {"x": ArraySpec((2,))}, 2.0, None),),
)
DRAWING = """
import matplotlib.pyplot as plt
def f(x):
    fig = plt.figure()
    ax = fig.add_subplot(projection="3d")
    fig.canvas.draw()
    return [x, x]
"""


def main() -> None:
    """Measure and print one line per measurement."""
    isolation = choose()
    first, second = Sandbox(isolation), Sandbox(isolation)
    for sandbox in (first, second):
        sandbox.self_test()
    print(f"\nisolation: {isolation.name}")
    warm = latency(first, "trivial play")
    bare = Sandbox(process_isolation(()))
    bare.start()
    latency(bare, "the same without any layer")
    bare.close()
    latency(without_namespaces := Sandbox(process_isolation()), "the same without namespaces")
    without_namespaces.close()
    cold = statistics.median(timed(lambda: _cold(isolation)) for _ in range(5))
    times = f"{cold / warm:.0f} times the warm play"
    print(f"{'cold bwrap and Python per submission':44} {1e3 * cold:8.0f} ms   {times}")
    trivial = rate([first, second], lambda s: s.play(TRIVIAL))
    print(f"{'trivial plays, two zygotes':44} {trivial:8.0f} /s      goal 100")
    job = _probing()
    probed = rate([first, second], lambda s: _probe(s, job))
    print(f"{'euler_eqs at all hidden points, two zygotes':44} {probed:8.0f} /s      goal 50")
    memory(first)
    kill_latency(first)
    for sandbox in (first, second):
        sandbox.close()


def latency(sandbox: Sandbox, name: str, plays: int = 100) -> float:
    """Print the median time to the submission's first line and of a whole play.
    Return the latter in seconds.
    """
    first_line, whole = [], []
    for _ in range(plays):
        began = time.clock_gettime(time.CLOCK_MONOTONIC)
        result = sandbox.play(TRIVIAL)
        whole.append(time.clock_gettime(time.CLOCK_MONOTONIC) - began)
        first_line.append(float(result.stdout) - began)
    start, total = (1e3 * statistics.median(x) for x in (first_line, whole))
    high = 1e3 * statistics.quantiles(whole, n=20)[-1]
    print(
        f"{name:44} {start:8.1f} ms to the student's first line (goal 10), {total:.1f} ms in all (goal 20),"
        f" p95 {high:.1f}"
    )
    return total / 1e3


def rate(sandboxes: list[Sandbox], play: Callable[[Sandbox], object], seconds: float = 3.0) -> float:
    """Return the plays per second with all sandboxes at work."""
    counts, until = [0] * len(sandboxes), time.monotonic() + seconds

    def work(k: int) -> None:
        while time.monotonic() < until:
            play(sandboxes[k])
            counts[k] += 1

    threads = [threading.Thread(target=work, args=(k,)) for k in range(len(sandboxes))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return sum(counts) / seconds


def memory(sandbox: Sandbox) -> None:
    """Print the resident size of the zygote, and the private memory of a child that computes and of one that
    draws.
    """
    pid = sandbox._zygote._started.process.pid
    # bubblewrap's own processes come first
    while not os.path.basename(os.readlink(f"/proc/{pid}/exe")).startswith("python"):
        pid = int(Path(f"/proc/{pid}/task/{pid}/children").read_text().split()[0])
    print(f"{'zygote, resident':44} {_memory(pid, 'Rss') / 1024:8.0f} MB      goal 130")
    for name, source, goal in (
        ("computes", "def f(x):\n    return [x, x]", 5),
        ("has drawn a figure", DRAWING, 25),
    ):
        held = source.replace("return", "import time; time.sleep(0.5); return")
        thread = threading.Thread(
            target=sandbox.play, args=(replace(TRIVIAL, cells=(Cell("submission.py", held),)),)
        )
        thread.start()
        largest = 0.0
        while thread.is_alive():
            for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split():
                largest = max(largest, _memory(int(child), "Private_Dirty"))
            time.sleep(0.02)
        thread.join()
        print(f"{f'private memory of a child that {name}':44} {largest / 1024:8.1f} MB      goal {goal}")


def kill_latency(sandbox: Sandbox) -> None:
    """Print the time from the end of the wall-clock limit until the child is reaped."""
    session.GRACE_S = 0.0
    source = "import signal\nsignal.pthread_sigmask(signal.SIG_BLOCK, [14])\ndef f(x):\n    while True: pass"
    job = replace(
        TRIVIAL, cells=(Cell("submission.py", source),), scenes=(replace(TRIVIAL.scenes[0], budget_s=0.3),)
    )
    late = [timed(lambda: sandbox.play(job)) - CLOCK_FACTOR * 0.3 for _ in range(10)]
    after = 1e3 * statistics.median(late)
    print(f"{'an endless loop ends after its limit by':44} {after:8.0f} ms      goal 100")


def timed(run: Callable[[], object]) -> float:
    """Return the wall time of one call in seconds."""
    began = time.perf_counter()
    run()
    return time.perf_counter() - began


def _cold(isolation) -> None:
    command = [
        *isolation.around,
        isolation.inside[0],
        "-I",
        "-S",
        "-B",
        "-c",
        _IMPORTS.format(path=_path(isolation)),
    ]
    subprocess.run(command, env=dict(isolation.environment), check=True)


_IMPORTS = (
    "import sys; sys.path += {path!r}; import numpy, scipy.integrate, matplotlib.pyplot,"
    " matplotlib.animation, polhode.animation.animation_recording"
)


def _path(isolation) -> list[str]:
    import json

    return json.loads(isolation.inside[-1])["path"]


def _probing() -> Job:
    assignment = find("rigid-body")
    scene = assignment.scene("probes")
    return job_of(Submission(RIGHT), assignment, [scene], {"probes": draw_inputs(scene, 1)})


def _probe(sandbox: Sandbox, job: Job) -> None:
    assert sandbox.play(job).finished("probes")


def _memory(pid: int, kind: str) -> float:
    """Return the KiB of ``kind`` in /proc/pid/smaps_rollup, 0 for a process that has ended."""
    try:
        text = Path(f"/proc/{pid}/smaps_rollup").read_text()
    except OSError:
        return 0.0
    return float(next(line.split()[1] for line in text.splitlines() if line.startswith(f"{kind}:")))


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main()
