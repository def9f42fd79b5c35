"""The likely cause behind wrong moments, of a box from its edges or of a tensor."""

import itertools

import numpy as np
from numpy.typing import NDArray

import reference
from ecp.outcome import Diagnosis
from exercises.assignment import Inputs

Array = NDArray[np.float64]

AGREEMENT = 1e-10
EDGES = ("a", "b", "c")
MOMENT = ("I₁", "I₂", "I₃")


def causes_of_boxes(inputs: Inputs, moments: Array) -> list[Diagnosis]:
    """For ``box_moments``, (n, 3) for the boxes (m, a, b, c) asked: an order, a convention, or what each moment is made of."""
    boxes = np.asarray(inputs["boxes"], dtype=float)
    truth = np.array([reference.box_moments(*row) for row in boxes])
    if _same(moments, truth):
        return []
    if empty := _nothing(moments, "box_moments"):
        return empty
    for order in itertools.permutations(range(3)):
        if _same(moments, truth[:, order]):
            stands = ", ".join(MOMENT[k] for k in order)
            return [_cause("moment-order", f"the right moments in the wrong order: {stands}; the first belongs to the edge a")]
    if _same(moments, np.sort(truth, axis=1)):
        return [_cause("moment-order", "the right moments, but sorted: the first belongs to the edge a whatever its size")]
    found = [_read(boxes, moments[:, k], k) for k in range(3)]
    if any(cause is None for cause in found):
        return []
    told = {c.sentence: c for cause in found if cause for c in cause}
    return list(told.values())


def causes_of_tensors(inputs: Inputs, moments: Array) -> list[Diagnosis]:
    """For ``principal_moments``, (n, 3) for the tensors asked; their order is free."""
    tensors = np.asarray(inputs["tensors"], dtype=float)
    seen, truth = np.sort(moments, axis=1), reference.principal_moments(tensors)
    if empty := _nothing(seen, "principal_moments"):
        return empty
    if _same(seen, np.sort(np.diagonal(tensors, axis1=1, axis2=2), axis=1)):
        return [_cause("diagonal-only", "the diagonal of the tensor: the principal moments are its eigenvalues")]
    factor = float(np.sum(seen * truth) / np.sum(truth * truth))
    if not _same(seen, truth) and _same(seen, factor * truth):
        return [_factor(factor)]
    for name, value in (("the square roots of the moments", np.sqrt(truth)), ("the inverse moments", np.sort(1 / truth, axis=1))):
        if _same(seen, value):
            return [_cause("wrong-quantity", f"{name} instead of the moments themselves")]
    return []


def _nothing(moments: Array, function: str) -> list[Diagnosis]:
    if not np.all(np.isfinite(moments)):
        return [_cause("not-finite", f"{function} returns values that are not finite")]
    return [] if moments.any() else [_cause("returns-zero", f"{function} returns zeros whatever it is asked")]


def _read(boxes: Array, column: Array, k: int) -> list[Diagnosis] | None:
    """What one moment is made of: weights of the squared edges and their products, with the mass or without."""
    m, edges = boxes[:, 0], boxes[:, 1:]
    if not column.any():
        return [_cause("missing-component", f"{MOMENT[k]} is always zero")]
    pairs = list(itertools.combinations_with_replacement(range(3), 2))
    made_of = np.column_stack([edges[:, a] * edges[:, b] for a, b in pairs])
    for mass, without in ((m, False), (np.ones_like(m), True)):
        design = made_of * mass[:, None]
        weights = np.linalg.lstsq(design, column, rcond=None)[0] * 12
        if np.abs(design @ weights / 12 - column).max() > AGREEMENT * np.abs(column).max():
            continue
        weights[np.abs(weights) < 1e-8 * np.abs(weights).max()] = 0.0
        lacks = [_cause("missing-term", f"{MOMENT[k]} does not hold the mass m")] if without else []
        return [*lacks, *_weighed(dict(zip(pairs, weights.tolist(), strict=True)), k)]
    return None


def _weighed(weights: dict[tuple[int, int], float], k: int) -> list[Diagnosis]:
    i, j = sorted({0, 1, 2} - {k})
    due, used = {(i, i), (j, j)}, {pair for pair, x in weights.items() if x}
    first, second = weights[i, i], weights[j, j]
    if used == due and np.isclose(first, second, rtol=1e-9):
        return [] if np.isclose(first, 1, rtol=1e-9) else [_factor(first)]
    if used == due and np.isclose(first, -second, rtol=1e-9):
        return [_cause("sign-flipped", f"{MOMENT[k]} holds {EDGES[i]}² − {EDGES[j]}² where {EDGES[i]}² + {EDGES[j]}² belongs")]
    is_ = " + ".join(f"{EDGES[a]}²" if a == b else f"{EDGES[a]}{EDGES[b]}" for a, b in sorted(used))
    code = "missing-term" if used < due else "cyclic-order" if all(a == b for a, b in used) else "extra-term"
    return [_cause(code, f"{MOMENT[k]} is made of {is_} where {EDGES[i]}² + {EDGES[j]}² belongs")]


def _factor(factor: float) -> Diagnosis:
    known = {12.0: "the division by 12 is missing", 4.0: "m/12 belongs to full edges, m/3 to half edges"}
    hint = known.get(round(factor, 9), "look for a factor that does not belong")
    return _cause("constant-factor", f"{factor:.10g} times the right value: {hint}")


def _same(seen: Array, expected: Array) -> bool:
    return bool(np.all(np.abs(seen - expected) <= AGREEMENT * np.abs(expected).max()))


def _cause(code: str, sentence: str) -> Diagnosis:
    return Diagnosis(code=code, sentence=sentence, confidence=1.0)
