"""Bodies of euler_eqs that are right along exact motions, or in the usual cases, and wrong elsewhere."""

import textwrap

RIGHT = "np.cross(np.asarray(I) * w, w) / np.asarray(I)"
ENERGY, MOMENTUM = "np.sum(np.asarray(I) * np.square(w))", "np.sum(np.square(np.asarray(I) * w))"
# Each is a function's body. The notebook's bodies and spins are I = (1, 2, 3) kg m² and like it: see
# wrong_right_for_one_body.py.
ONLY_HERE = {
    "energy of the first call": (
        f"""
        energy = {ENERGY}
        first = euler_eqs.__dict__.setdefault("energy", energy)
        return {RIGHT} + 1e-3 * (energy - first) * np.asarray(w)"""
    ),
    "momentum of the first call": (
        f"""
        momentum = {MOMENTUM}
        first = euler_eqs.__dict__.setdefault("momentum", momentum)
        return {RIGHT} * (1.0 if abs(momentum - first) < 1e-3 * first else 1.1)"""
    ),
    "moments of the first call": (
        f"""
        first = euler_eqs.__dict__.setdefault("I", np.array(I))
        return {RIGHT.replace("np.asarray(I)", "first")}"""
    ),
    "a larger energy than the body's before": (
        f"""
        energies = euler_eqs.__dict__.setdefault("energies", {{}})
        energy = {ENERGY}
        return {RIGHT} * (1.0 if energy <= 1.001 * energies.setdefault(tuple(I), energy) else 2.0)"""
    ),
    "late": f"return {RIGHT} if t <= 20 else np.zeros(3)",
    "early": f"return {RIGHT} if t > 0.25 else np.zeros(3)",
    "called at single points only": (
        f"""
        import sys
        frame, names = sys._getframe(1), set()
        while frame:
            names.add(frame.f_code.co_filename.rpartition("/")[2])
            frame = frame.f_back
        return {RIGHT} if "values.py" in names else np.zeros(3)"""
    ),
    "called by an integrator only": (
        f"""
        import sys
        frame, names = sys._getframe(1), set()
        while frame:
            names.add(frame.f_code.co_filename.rpartition("/")[2])
            frame = frame.f_back
        return np.zeros(3) if "values.py" in names else {RIGHT}"""
    ),
    "consecutive times only": (
        f"""
        before, euler_eqs.t = getattr(euler_eqs, "t", t), t
        return {RIGHT} if abs(t - before) < 1.0 else np.zeros(3)"""
    ),
    "every fiftieth call": (
        f"""
        euler_eqs.calls = getattr(euler_eqs, "calls", 0) + 1
        return {RIGHT} * (2.0 if euler_eqs.calls % 50 == 0 else 1.0)"""
    ),
    "after sixty calls": (
        f"""
        euler_eqs.calls = getattr(euler_eqs, "calls", 0) + 1
        return {RIGHT} * (2.0 if euler_eqs.calls > 60 else 1.0)"""
    ),
    "the first sixty calls": (
        f"""
        euler_eqs.calls = getattr(euler_eqs, "calls", 0) + 1
        return {RIGHT} * (2.0 if euler_eqs.calls <= 60 else 1.0)"""
    ),
    "fast spins": f"return {RIGHT} * (1.0 if np.max(np.abs(w)) < 100 else 1.5)",
    "slow spins": f"return {RIGHT} * (1.0 if np.max(np.abs(w)) > 1e-2 else 1.5)",
    "far from every axis": f"return {RIGHT} * (1.0 if np.max(np.abs(w)) > 0.8 * np.linalg.norm(w) else 1.01)",
    "large moments": f"return {RIGHT} * (1.0 if np.max(I) < 100 else 1.5)",
    "moments in falling order": f"return {RIGHT} * (1.0 if I[0] <= I[2] else -1.0)",
    "not nearly spherical": f"return {RIGHT} + (np.ptp(I) < 0.01 * np.max(I)) * 1e-6",
    "two negative components": f"return {RIGHT} * (1.0 if np.sum(np.sign(w)) > -1 else 1.5)",
    "the second call at a point": (
        f"""
        seen = euler_eqs.__dict__.setdefault("seen", set())
        again = (*w, *I) in seen
        seen.add((*w, *I))
        return {RIGHT} * (1.5 if again else 1.0)"""
    ),
    "no drag at slow spins": (
        f"return {RIGHT} + (0.0 if np.linalg.norm(w) < 50 else 1e-7 * np.linalg.norm(w) ** 2)"
    ),
}


def source(body):
    """The function of this body as a student writes it."""
    return "def euler_eqs(t, w, I):\n" + textwrap.indent(textwrap.dedent(body).strip(), "    ")


def sources():
    """The functions by a name that can be that of a file."""
    return {name.replace(" ", "_"): source(body) for name, body in ONLY_HERE.items()}
