"""CPU time of grading the course's notebook, warm, against executing its cells once in plain Python and as
Jupyter shows them.
"""

import contextlib
import io
import json
import multiprocessing
import os
import statistics
import time

from exercises.authoring.assignments.catalogue import find
from service.grading.figures.rendering import pack
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.isolation.select import choose
from service.sandbox.sandbox import Sandbox

RIGID_BODY = find("rigid-body")
FILE = RIGID_BODY.folder / "samples" / "right_course_notebook.ipynb"
TIMES = 5


def main() -> None:
    """Measure and print one line per measurement. Grading and executing alternate."""
    sandbox = Sandbox(choose())
    sandbox.self_test()
    graded, plain, shown = [], [], []
    with multiprocessing.get_context("spawn").Pool(1, maxtasksperchild=1) as pool:
        for seed in range(TIMES):
            graded.append(_grade(sandbox, seed))
            once, display = pool.apply(executed)
            plain.append(once)
            shown.append(once + display)
    sandbox.close()
    ours, once, displayed = map(statistics.median, (graded, plain, shown))
    print(f"\n{FILE.name}, CPU time, load {os.getloadavg()[0]:.1f}")
    print(f"{'grading, warm, with figures':44} {1e3 * ours:8.0f} ms")
    print(
        f"{'every cell once, nothing shown':44} {1e3 * once:8.0f} ms   grading {ours / once:.2f} times as"
        " much, goal 1.5"
    )
    print(
        f"{'the same, with figures and player shown':44} {1e3 * displayed:8.0f} ms   grading"
        f" {ours / displayed:.2f} times as much"
    )


def _grade(sandbox: Sandbox, seed: int) -> float:
    began = time.process_time()
    graded = grade(Submission.from_bytes(FILE.read_bytes(), FILE.name), RIGID_BODY, sandbox, seed)
    pack(graded)
    if not graded.report.passed:
        raise RuntimeError(f"{FILE.name} does not pass")
    spent = time.process_time() - began + graded.cpu_s
    return spent


def executed() -> tuple[float, float]:
    """Return the CPU time of the cells, and that of drawing their figures and player as a notebook's front
    end shows them.
    """
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.animation
    import matplotlib.pyplot as plt
    import mpl_toolkits.mplot3d.art3d  # noqa: F401 -- imports are warm in a guest, too
    import scipy.integrate  # noqa: F401

    import polhode
    from polhode.animation import animate

    polhode.check = polhode.submit = lambda *args, **kwargs: None
    cells = [
        cell for cell in json.loads(FILE.read_text(encoding="utf-8"))["cells"] if cell["cell_type"] == "code"
    ]
    sources = ["".join(line for line in cell["source"] if not line.startswith("%")) for cell in cells]
    names = {"__name__": "__main__", "display": lambda *args: None}
    began = time.process_time()
    with contextlib.redirect_stdout(io.StringIO()):
        for source in sources:
            exec(source, names)
    ended = time.process_time()
    for number in plt.get_fignums():
        plt.figure(number).canvas.draw()
    for animation in animate.shown:
        animation.to_jshtml()
    return ended - began, time.process_time() - ended


if __name__ == "__main__":
    main()
