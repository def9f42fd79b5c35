"""Functions that try to profit from being asked everything in one process: right for some calls and wrong for
others, by how often, when, by whom or with what they are called.
"""

import textwrap

RIGHT = "np.cross(np.asarray(I) * w, w) / np.asarray(I)"
BEFORE = """
import gc
import sys
import time
import numpy as np

calls, seen, started, clock = [0], {}, time.monotonic(), time.process_time()
"""
POINTS = 1060  # of one list

IN_PART = {
    "right at points, wrong in the integration, by the caller's name": f"""
        of_integrator = sys._getframe(1).f_code.co_name == "evaluate"
        return {RIGHT} * (1.5 if of_integrator else 1.0)
        """,
    "right in the integration, wrong at points, by the caller's name": f"""
        of_integrator = sys._getframe(1).f_code.co_name == "evaluate"
        return {RIGHT} * (1.0 if of_integrator else 1.5)
        """,
    "right at points, wrong in the integration, by the size of the stack": f"""
        depth, frame = 0, sys._getframe()
        while frame := frame.f_back:
            depth += 1
        return {RIGHT} * (1.0 if depth == seen.setdefault("depth", depth) else 1.5)
        """,
    "right as often as there are points": f"""
        calls[0] += 1
        return {RIGHT} * (1.0 if calls[0] <= {POINTS} else 1.5)
        """,
    "wrong as often as there are points": f"""
        calls[0] += 1
        return {RIGHT} * (1.5 if calls[0] <= {POINTS} else 1.0)
        """,
    "right for a hundredth of a second": f"""
        return {RIGHT} * (1.0 if time.monotonic() - started < 0.01 else 1.5)
        """,
    "right after a hundredth of a second of CPU time": f"""
        return {RIGHT} * (1.0 if time.process_time() - clock > 0.01 else 1.5)
        """,
    "right where it has been before": f"""
        key = np.round(np.linalg.norm(np.asarray(I) * w), 6)
        seen[key] = seen.get(key, 0) + 1
        return {RIGHT} * (1.0 if seen[key] > 1 else 1.5)
        """,
    "right while the body stays the same": f"""
        same = seen.get("I") == tuple(I)
        seen["I"] = tuple(I)
        return {RIGHT} * (1.0 if same else 1.5)
        """,
    "right while the body changes": f"""
        same = seen.get("I") == tuple(I)
        seen["I"] = tuple(I)
        return {RIGHT} * (1.5 if same else 1.0)
        """,
    "right where the job lists the point": f"""
        if "listed" not in seen:
            jobs = [x for x in gc.get_objects() if isinstance(x, dict) and "w" in x and "I" in x and "t" in x]
            seen["listed"] = {{tuple(row) for job in jobs for row in np.reshape(job["w"], (-1, 3)).tolist()}}
        return {RIGHT} * (1.0 if tuple(w) in seen["listed"] else 1.5)
        """,
    "wrong, with the play's own comparison and integrator replaced": f"""
        if not calls[0]:
            calls[0] = 1
            import polhode.judging.integration, polhode.judging.return_value
            polhode.judging.return_value.real_array = lambda value, *rest: value / 1.5
            zeros = lambda rates, start, times, *rest: np.zeros((len(start), len(times)))
            polhode.judging.integration.integrate = zeros
            np.array_equal = lambda *values, **options: True
        return {RIGHT} * 1.5
        """,
}


def source(body):
    """Return the function of this body as a student writes it."""
    return (
        f"{BEFORE}\ndef euler_eqs(t, w, I):\n" + textwrap.indent(textwrap.dedent(body).strip(), "    ") + "\n"
    )
