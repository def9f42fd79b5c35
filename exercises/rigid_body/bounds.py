"""The error of a motion, bounded by the values of ``euler_eqs`` at points along the exact one.

To first order, the motion of rates that are off by at most δ at these points is off by δ times the
``duration`` of reference.sensitivities, and its attitude by that times the angle turned in addition.
"""

from dataclasses import replace

import numpy as np

from exercises.rigid_body.public.common_checks import PRODUCT
from exercises.rigid_body.public.quantities import as_closely
from polhode.judging.checks import Arrays, Check
from polhode.judging.judge import Judgement, Verdict, within
from polhode.judging.outcome import Tolerance


def bounded(id: str, label: str, motion: str) -> Check:
    """Check that a drawn motion, which is not integrated, follows the exact one as closely as any integrator
    must.
    """
    return Check(
        id,
        label,
        ("probes",),
        lambda seen, truth: _judge(seen[0], truth[0], motion),
        Tolerance(reason=f"of |ω(0)|: {PRODUCT}"),
        allow=lambda truth: as_closely(_of(truth, motion)),
        arrays=(),
    )


def with_bound(check: Check) -> Check:
    """Return a check of an integrated motion that also requires the bound from the points along it."""
    (motion,) = check.scenes
    locate, allow = check.locate, check.allow
    assert locate is not None and allow is not None

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        found = check.word(seen[:1], truth[:1])
        along = _judge(seen[1], truth[1], motion)
        return along if found.verdict is Verdict.PASS and along.verdict is not Verdict.PASS else found

    return replace(
        check,
        scenes=(motion, "probes"),
        word=word,
        locate=lambda index, seen, points: locate(index, seen),
        allow=lambda truth, points: allow(truth),
        arrays=("w", "R"),
    )


def _judge(seen: Arrays, truth: Arrays, motion: str) -> Judgement:
    known = _of(truth, motion)
    rows = known["rows"]
    with np.errstate(all="ignore"):  # numbers may be too large for arithmetic: their bound is infinite
        off = np.linalg.norm(seen["wdot"][rows] - truth["wdot"][rows], axis=1).max() / known["speed"]
        bound = float(off * known["duration"] * known["turned"])
    limit = float(as_closely(known).limit or 0.0)
    how = f"euler_eqs at {len(rows)} points along the exact motion"
    found = within(bound, 0.0, 1.0, limit)
    return replace(found, detail=f"max|Δ|/scale ≤ {bound:.6g} (limit {limit:g}), by {how}", where=None)


def _of(truth: Arrays, motion: str) -> Arrays:
    """Return what probes.exact says of a motion."""
    begin = f"{motion}: "
    return {name.removeprefix(begin): value for name, value in truth.items() if name.startswith(begin)}
