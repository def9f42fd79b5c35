"""The likely cause behind wrong moments, of a box from its edges or of a tensor."""

import itertools
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

import reference
from ecp.outcome import Diagnosis
from exercises.assignment import Inputs

Array = NDArray[np.float64]

AGREEMENT = 1e-10
NEARLY = 0.03
SINGLE, ROUNDING = 1e-6, 1e-12  # relative errors of single precision and of right moments
DECIMALS = range(12)
EDGES = ("a", "b", "c")
MOMENT = ("I₁", "I₂", "I₃")
DIAGONAL = "the diagonal of the tensor: the principal moments are its eigenvalues"
UNFINISHED = "the sum is right, but the values are the diagonal of a tensor that is not diagonal yet: use np.linalg.eigvalsh"
MASSLESS = "lacks the mass m"


def causes_of_boxes(inputs: Inputs, moments: Array) -> list[Diagnosis]:
    """Return the causes for ``box_moments``, (n, 3) in kg m² for the boxes (m, a, b, c): an order, a
    convention, or its wrong terms.
    """
    boxes = np.asarray(inputs["boxes"], dtype=float)
    truth = np.array([reference.box_moments(*row) for row in boxes])
    constant = "box_moments returns the same numbers for every box{}: compute them from a, b and c"
    known = (
        _nothing(moments, "box_moments")
        or _few_digits(moments, truth)
        or _constant(moments, constant.format(""))
        or _constant(moments / boxes[:, :1], constant.format(", times the mass"))
    )
    if known or _same(moments, truth):
        return known
    for code, sentence, value in _box_mistakes(boxes, truth):
        if _same(moments, value):
            return [_cause(code, sentence)]
    ratio = moments / truth
    off = float(np.abs(ratio - 1).max())
    if off <= NEARLY and np.ptp(ratio, axis=0).max() > AGREEMENT:
        return [_nearly(f"within {off:.2g} of the right moments")]
    found = [_read(boxes, moments[:, k], k) for k in range(3)]
    if any(cause is None for cause in found):
        return []
    causes = {c.sentence: c for cause in found if cause for c in cause}
    massless = [cause for cause in causes.values() if cause.sentence.endswith(MASSLESS)]
    if len(massless) == 3:
        return [_cause("missing-term", "the moments lack the mass m"), *(c for c in causes.values() if c not in massless)]
    return list(causes.values())


def _box_mistakes(boxes: Array, truth: Array) -> Iterator[tuple[str, str, Array]]:
    m, squares = boxes[:, :1], boxes[:, 1:] ** 2
    first, second = squares[:, [1, 0, 0]], squares[:, [2, 2, 1]]
    for order in itertools.permutations(range(3)):
        stands = ", ".join(MOMENT[k] for k in order)
        sentence = f"the right moments in the wrong order: {stands}; the first belongs to the edge a"
        yield "moment-order", sentence, truth[:, order]
    sorted_ = "the right moments, but sorted: the first belongs to the edge a, whatever its size"
    yield "moment-order", sorted_, np.sort(truth, axis=1)
    yield "wrong-power", "the square roots of the moments instead of the moments", np.sqrt(truth)
    yield "wrong-quantity", "the inverse moments instead of the moments", 1 / truth
    yield "wrong-quantity", "the radii of gyration √(I/m) instead of the moments", np.sqrt(truth / m)
    yield "floor-division", "the moments are cut to whole numbers: look for floor division (//) or int", np.floor(truth)
    yield "floor-division", "m is divided by 12 with //, which drops the fraction: use /", m // 12 * (first + second)
    for b, c in ((first, second), (squares[:, [1, 2, 0]], squares[:, [2, 0, 1]])):  # of I₂: a² + c², or c² + a²
        for place, value in (("m/12·b² + c²", m / 12 * b + c), ("b² + c²·m/12", b + m / 12 * c), ("m·b² + c²/12", m * b + c / 12)):
            yield "missing-brackets", f"I₁ is computed as {place}, and so on: (b² + c²) needs its brackets", value
    unsquared = "the edges are not squared: I₁ has b + c instead of b² + c²"
    yield "wrong-power", unsquared, m / 12 * (np.sqrt(first) + np.sqrt(second))
    yield "wrong-power", "I₁ has 2b + 2c instead of b² + c²: the square is b**2", m / 6 * (np.sqrt(first) + np.sqrt(second))
    yield "wrong-power", "I₁ has the root of b² + c², and so on: look for np.hypot or a norm", m / 12 * np.sqrt(first + second)
    volume = np.prod(boxes[:, 1:], axis=1, keepdims=True)
    yield "wrong-quantity", "the right moments times the volume abc: m is the mass, not the density", truth * volume
    yield "wrong-quantity", "the right moments divided by the volume abc: m is the mass, not the density", truth / volume
    exchanged = np.array([reference.box_moments(row[3], *row[:3]) for row in boxes])
    yield "swapped-arguments", "the arguments are taken as (a, b, c, m): box_moments is called as (m, a, b, c)", exchanged


def causes_of_tensors(tensors: Array, moments: Array) -> list[Diagnosis]:
    """Return the causes for ``principal_moments``, (n, 3) in kg m², in any order, for the ``tensors`` (n, 3, 3)."""
    seen, truth = np.sort(moments, axis=1), reference.principal_moments(tensors)
    if (known := _nothing(seen, "principal_moments") or _few_digits(seen, truth)) or _same(seen, truth):
        return known
    for code, sentence, value in _tensor_mistakes(tensors, truth):
        if _same(seen, np.sort(value, axis=1)):
            return [_cause(code, sentence)]
    factor = float(np.sum(seen * truth / truth**2) / seen.size)
    if np.isfinite(factor) and _same(seen, factor * truth) and (len(truth) > 1 or f"{factor:.3g}" == f"{factor:.9g}"):
        return [_cause("constant-factor", f"{factor:.10g} times the right value: look for an extra factor")]
    _, axes = np.linalg.eigh(tensors)
    sizes = np.sort(np.abs(moments), axis=1)
    for vectors in (axes, np.swapaxes(axes, 1, 2)):
        if np.all(np.any(np.all(np.abs(np.sort(np.abs(vectors), axis=1) - sizes[:, :, None]) < 1e-6, axis=1), axis=1)):
            return [_cause("wrong-quantity", "a principal axis (an eigenvector), not the moments: np.linalg.eigh returns both")]
    if _majorised(seen, truth):
        return [_cause("diagonal-only", UNFINISHED)]
    off = float(np.abs(seen / truth - 1).max())
    shares = seen / np.trace(tensors, axis1=1, axis2=2)[:, None]
    constant = _constant(shares, "the same shares of the trace for every tensor: return its eigenvalues")
    return [_nearly(f"within {off:.2g} of the right moments")] if off <= NEARLY else constant


def _majorised(seen: Array, truth: Array) -> bool:
    """Return whether the sorted values (n, 3) can be the diagonal of a tensor with the eigenvalues ``truth``
    (Schur and Horn).
    """
    excess = np.cumsum(truth - seen, axis=1) / truth.max(axis=1, keepdims=True)
    return bool(np.all(excess <= AGREEMENT) and np.all(np.abs(excess[:, 2]) <= AGREEMENT))


def _tensor_mistakes(tensors: Array, truth: Array) -> Iterator[tuple[str, str, Array]]:
    instead = "instead of the moments themselves"
    third = np.repeat(truth.mean(axis=1, keepdims=True), 3, axis=1)
    diagonal = np.diagonal(tensors, axis1=1, axis2=2)
    yield "diagonal-only", DIAGONAL, diagonal
    ones = "the lengths of the eigenvectors, which are all 1: np.linalg.eigh returns the eigenvalues first"
    yield "wrong-quantity", ones, np.ones_like(truth)
    yield "sign-reversed", "the opposite sign: moments of inertia are positive", -truth
    yield "wrong-quantity", f"the square roots of the moments {instead}", np.sqrt(truth)
    yield "wrong-quantity", f"the inverse moments {instead}", 1 / truth
    yield "wrong-quantity", f"the squares of the moments {instead}", truth**2
    yield "wrong-quantity", "every value is a third of the trace; only the sum is right: return the eigenvalues", third
    yield "wrong-quantity", "the lengths of the columns of the tensor: return its eigenvalues", np.linalg.norm(tensors, axis=1)
    yield "wrong-quantity", "the sums of the rows of the tensor: return its eigenvalues", tensors.sum(axis=1)
    signless = "the eigenvalues of the absolute values of the tensor: its signs are lost"
    yield "absolute-value", signless, np.linalg.eigvalsh(np.abs(tensors))
    opposite = "the off-diagonal elements have the opposite sign: use the tensor as it is given"
    yield "sign-flipped", opposite, np.linalg.eigvalsh(np.asarray(2 * diagonal[:, None] * np.eye(3) - tensors, dtype=float))
    second = "these are the second moments of the mass, half the trace minus each moment: return the moments of inertia"
    yield "wrong-quantity", second, truth.sum(axis=1, keepdims=True) / 2 - truth
    factor = "this is the diagonal of a triangular factor, as from Gaussian elimination"
    triangular = f"{factor}; only the product is right: return the eigenvalues"
    yield "wrong-quantity", triangular, np.array([_pivots(tensor) for tensor in tensors])
    upper = np.array([np.diagonal(np.linalg.qr(tensor)[1]) for tensor in tensors])
    yield "wrong-quantity", triangular, upper
    yield "wrong-quantity", triangular, np.abs(upper)
    for name, size in (
        ("their length", np.linalg.norm(truth, axis=1)),
        ("their sum", truth.sum(axis=1)),
        ("the largest", truth[:, -1]),
        ("the smallest", truth[:, 0]),
        ("the middle one", truth[:, 1]),
    ):
        yield "normalised", f"the right moments divided by {name}", truth / size[:, None]
    whole = "the tensor is cut to whole numbers: look for an array of integers"
    yield "precision-loss", whole, np.linalg.eigvalsh(np.trunc(tensors))
    yield "precision-loss", "the moments are cut to whole numbers", np.trunc(truth)
    for places in range(9):
        yield "precision-loss", f"the moments are rounded to {places} decimal places", np.round(truth, places)


def _pivots(tensor: Array) -> Array:
    """Return the pivots (3,) of an elimination without row exchanges."""
    minors = [np.linalg.det(tensor[:k, :k]) for k in (1, 2, 3)]
    return np.array(minors) / [1.0, *minors[:2]]


def _nothing(moments: Array, function: str) -> list[Diagnosis]:
    if not np.all(np.isfinite(moments)):
        return [_cause("not-finite", f"{function} returns values that are not finite")]
    return [] if moments.any() else [_cause("returns-zero", f"{function} returns zeros for all arguments")]


def _constant(values: Array, sentence: str) -> list[Diagnosis]:
    """Return the diagnosis if the rows of ``values`` (n, 3) are all the same."""
    same = len(values) > 1 and _same(values, np.broadcast_to(values[0], values.shape))
    return [_cause("hard-coded-moments", sentence)] if same else []


def _few_digits(moments: Array, truth: Array) -> list[Diagnosis]:
    """Return the diagnosis if the moments (n, 3) are the right ones with fewer digits."""
    slack = 4 * np.finfo(float).eps * np.abs(moments)
    for decimals in DECIMALS:
        half = 0.5000001 * 10.0**-decimals + ROUNDING * truth.max(axis=1, keepdims=True)
        if np.all((np.abs(moments - np.round(moments, decimals)) <= slack) & (np.abs(moments - truth) <= half)):
            return [_cause("precision-loss", f"the moments are rounded to {decimals} decimals")]
    if np.array_equal(moments, moments.astype(np.float32)) and np.all(np.abs(moments / truth - 1) < SINGLE):
        return [_cause("precision-loss", "the moments are in single precision (float32)")]
    return []


def _read(boxes: Array, column: Array, k: int) -> list[Diagnosis] | None:
    """Return the errors in one moment's terms: weights of the squared edges and their products, with or
    without the mass.
    """
    m, edges = boxes[:, 0], boxes[:, 1:]
    if not column.any():
        return [_cause("missing-component", f"{MOMENT[k]} is always zero")]
    pairs = list(itertools.combinations_with_replacement(range(3), 2))
    made_of = np.column_stack([edges[:, a] * edges[:, b] for a, b in pairs])
    for mass, without in ((m, False), (np.ones_like(m), True)):
        design = made_of * mass[:, None]
        weight = 1 / (mass * (edges**2).sum(axis=1))  # so that boxes of every size count alike
        weights = np.linalg.lstsq(design * weight[:, None], column * weight, rcond=None)[0] * 12
        terms = design * weights / 12
        if np.any(np.abs(terms.sum(axis=1) - column) > AGREEMENT * np.abs(terms).sum(axis=1)):
            continue
        weights[np.abs(weights) < 1e-8 * np.abs(weights).max()] = 0.0
        lacks = [_cause("missing-term", f"{MOMENT[k]} {MASSLESS}")] if without else []
        return [*lacks, *_weighed(dict(zip(pairs, weights.tolist(), strict=True)), k)]
    return None


def _weighed(weights: dict[tuple[int, int], float], k: int) -> list[Diagnosis]:
    i, j = sorted({0, 1, 2} - {k})
    due, used = {(i, i), (j, j)}, {pair for pair, x in weights.items() if x}
    first, second = weights[i, i], weights[j, j]
    if used == due and np.isclose(first, second, rtol=1e-9):
        return [] if np.isclose(first, 1, rtol=1e-9) else [_factor(first)]
    if used == due and np.isclose(first, -second, rtol=1e-9):
        return [_cause("sign-flipped", f"{MOMENT[k]} has {EDGES[i]}² − {EDGES[j]}² instead of {EDGES[i]}² + {EDGES[j]}²")]
    if used == due:
        factors = f"{first:.6g} for {EDGES[i]}² and {second:.6g} for {EDGES[j]}²"
        return [_cause("constant-factor", f"{MOMENT[k]} has the factors {factors}, in units of m/12, instead of 1 and 1")]
    is_ = " + ".join(f"{EDGES[a]}²" if a == b else f"{EDGES[a]}{EDGES[b]}" for a, b in sorted(used))
    code = "missing-term" if used < due else "cyclic-order" if all(a == b for a, b in used) else "extra-term"
    return [_cause(code, f"{MOMENT[k]} has {is_} instead of {EDGES[i]}² + {EDGES[j]}²")]


def _factor(factor: float) -> Diagnosis:
    known = {
        12.0: "the division by 12 is missing",
        4.0: "m/12 belongs to full edges, m/3 to half edges",
        2.0: "use m/12, not m/6",
        0.25: "m/12 goes with full edge lengths, so do not halve a, b and c",
        2.4: "m/5 belongs to the semi-axes of an ellipsoid",
        0.6: "m/20 belongs to the axes of an ellipsoid, m/12 to the edges of a box",
    }
    if abs(factor - 1) <= NEARLY:
        return _nearly(f"{factor:.6g} times the right value")
    hint = known.get(round(factor, 9), "look for an extra factor")
    return _cause("constant-factor", f"{factor:.10g} times the right value: {hint}")


def _nearly(how: str) -> Diagnosis:
    sentence = f"nearly right: {how}: use the closed formula or np.linalg.eigvalsh instead of a numerical approximation"
    return Diagnosis(code="nearly-right", sentence=sentence, confidence=0.8)


def _same(seen: Array, expected: Array) -> bool:
    """Return whether all moments (n, 3) agree, each to rounding of its body's largest moment."""
    with np.errstate(all="ignore"):
        return bool(np.all(np.abs(seen - expected) <= AGREEMENT * np.abs(expected).max(axis=1, keepdims=True)))


def _cause(code: str, sentence: str) -> Diagnosis:
    return Diagnosis(code=code, sentence=sentence, confidence=1.0)
