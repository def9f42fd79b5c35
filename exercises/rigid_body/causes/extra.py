"""Extra terms: damping, drag, torques and constants added to the right equations, with their fitted size."""

import numpy as np
from numpy.typing import NDArray

import reference
from ecp.outcome import Diagnosis
from exercises.rigid_body.causes.agreement import AGREEMENT, ROUNDING
from exercises.rigid_body.causes.errors import COMPONENT, MOMENT, SPIN, Slip, diagnoses_of, slips
from exercises.rigid_body.causes.term_fit import Form, ordinary
from exercises.rigid_body.probes import scale

Array = NDArray[np.float64]
MOST_TERMS = 2
WHOLE = 10 * AGREEMENT
NOTHING = 1e-11  # of the largest term


def extra_terms(wdot: Array, t: Array, w: Array, moments: Array, columns: list[list[Form | None]]) -> list[Diagnosis]:
    """Return diagnoses if each component without a form is the right one, or a multiple of it, plus one or
    two known terms.

    ``columns`` are the forms of the other components.
    """
    truth, slack = reference.euler_rhs(w.T, moments.T).T, ROUNDING * scale(w, moments)
    found: list[Slip] = []
    sizes: dict[str, list[str]] = {}
    for k in range(3):
        if columns[k]:
            readings = [r for f in columns[k] if (r := slips(f, k)) is not None]
            if not readings:
                return []
            shortest: list[Slip] = min(readings, key=len)
            found += shortest
            continue
        names, terms = _terms(k, t, w, moments)
        fitted = _fit(wdot[:, k], np.column_stack([truth[:, k], *terms]), *ordinary(w, moments), slack[:, k])
        if fitted is None or not 0 < np.count_nonzero(fitted[1:]) <= MOST_TERMS:
            return []
        found += _multiple(float(fitted[0]), k)
        for name, size in zip(names, fitted[1:], strict=True):
            if size:
                sizes.setdefault(f"{size:+.6g} {name}".rstrip(), []).append(COMPONENT[k])
    terms_found = [
        Diagnosis(
            code="extra-term",
            sentence=f"{', '.join(where)} has an extra term {term}: torque-free equations have none",
            confidence=1.0,
        )
        for term, where in sizes.items()
    ]
    return [*diagnoses_of(found), *terms_found]


def _multiple(factor: float, k: int) -> list[Slip]:
    if abs(factor - 1) <= WHOLE:
        return []
    if factor == 0:
        return [Slip("missing-component", "zero", 0.0, k, f"{COMPONENT[k]} lacks its own term")]
    if abs(factor + 1) <= WHOLE:
        return [Slip("sign-flipped", "sign", 0.0, k, f"{COMPONENT[k]} has the opposite sign")]
    return [Slip("constant-factor", "factor", factor, k, f"{COMPONENT[k]} is {factor:.10g} times the right value")]


def _terms(k: int, t: Array, w: Array, moments: Array) -> tuple[list[str], list[Array]]:
    """Return names and values (n,) of terms that are commonly added to component ``k``."""
    spin, moment, speed = w[:, k], moments[:, k], np.linalg.norm(w, axis=1)
    named = {
        f"{SPIN[k]}": spin,
        f"{SPIN[k]}/{MOMENT[k]}": spin / moment,
        f"|ω|{SPIN[k]}": speed * spin,
        f"|{SPIN[k]}|{SPIN[k]}": np.abs(spin) * spin,
        f"|ω|{SPIN[k]}/{MOMENT[k]}": speed * spin / moment,
        f"|{SPIN[k]}|{SPIN[k]}/{MOMENT[k]}": np.abs(spin) * spin / moment,
        f"{SPIN[k]}³": spin**3,
        "": np.ones_like(t),
        f"/{MOMENT[k]}": 1 / moment,
        f"{SPIN[k]}²": spin**2,
        **{SPIN[a]: w[:, a] for a in range(3) if a != k},
    }
    return list(named), list(named.values())


def _fit(column: Array, design: Array, rows: NDArray[np.intp], weight: Array, slack: Array) -> Array | None:
    """Fit by least squares at the points ``rows``, without vanishing terms. None if the fit does not
    reproduce ``column`` to rounding.

    ``slack`` (n,) is the rounding error of the right value at each point.
    """
    weighted = design[rows] * weight[:, None]
    lengths = np.linalg.norm(weighted, axis=0)
    used = np.flatnonzero(lengths)
    for _ in range(design.shape[1]):  # drop vanishing terms until none is left
        fitted = np.linalg.lstsq(weighted[:, used] / lengths[used], column[rows] * weight, rcond=None)[0]
        if not fitted.size or not np.all(np.isfinite(fitted)):
            return None  # overflow
        kept = used[np.abs(fitted) > NOTHING * np.abs(fitted).max()]
        if len(kept) == len(used):
            break
        used = kept
    sizes = np.zeros(design.shape[1])
    sizes[used] = fitted / lengths[used]
    if np.any(np.abs(design @ sizes - column) > WHOLE * (np.abs(design) @ np.abs(sizes)) + slack):
        return None
    return sizes
