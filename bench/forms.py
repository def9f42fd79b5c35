"""Grading of fifteen right forms of ``euler_eqs``, exercise 2, on a warm sandbox: median, best and worst.

The forms differ in style, so in the rounding of their values and in what a call costs.
"""

import argparse
import statistics
import time

from exercises.authoring.assignments.catalogue import find
from service.grading.grade import grade
from service.grading.submission import Submission
from service.sandbox.isolation.select import choose
from service.sandbox.sandbox import Sandbox

RIGID_BODY = find("rigid-body")
FORMS = (
    "tuple_return",
    "cross",
    "matrix_times_w",
    "einsum_levi_civita",
    "roll",
    "oop",
    "closure_factory",
    "loop_modulo",
    "lambda",
    "terms",
    "inverse_tensor",
    "skew_matrix",
    "list_comprehension",
    "cached",
    "angular_momentum",
)


def main() -> None:
    """Print the wall and sandbox CPU time of each form, and of all of them."""
    parser = argparse.ArgumentParser(prog="python -m bench.forms", description=__doc__)
    parser.add_argument("--rounds", type=int, default=7, help="gradings of each form (default: 7)")
    rounds = parser.parse_args().rounds
    sandbox = Sandbox(choose())
    sandbox.self_test()
    wall, cpu = {form: list[float]() for form in FORMS}, {form: list[float]() for form in FORMS}
    for seed in range(rounds + 1):
        for form in FORMS:
            source = (RIGID_BODY.folder / "samples" / f"right_{form}.py").read_bytes()
            submission = Submission.from_bytes(source, "submission.py")
            began = time.perf_counter()
            graded = grade(submission, RIGID_BODY, sandbox, seed, ["2"])
            took = time.perf_counter() - began
            assert graded.report.passed, f"{form}: {graded.report.text()}"
            if seed:  # the first round warms up
                wall[form].append(took)
                cpu[form].append(graded.cpu_s)
    medians = {form: statistics.median(times) for form, times in wall.items()}
    for form, median in sorted(medians.items(), key=lambda one: one[1]):
        print(f"{form:24} {1e3 * median:7.1f} ms   {1e3 * statistics.median(cpu[form]):7.1f} ms of CPU time")
    found = [*medians.values()]
    print(
        f"fifteen forms: median {1e3 * statistics.median(found):.1f} ms, best {1e3 * min(found):.1f},"
        f" worst {1e3 * max(found):.1f}"
    )
    sandbox.close()


if __name__ == "__main__":
    main()
