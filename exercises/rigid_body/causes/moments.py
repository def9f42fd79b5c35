"""The likely cause behind wrong moments, of a box from its edges or of a tensor."""

import itertools

import numpy as np

import reference
from exercises.authoring.assignments.assignment import Inputs
from exercises.rigid_body.causes.algebra import MOMENT
from exercises.rigid_body.causes.fit import sums
from exercises.rigid_body.public.diagnosis import Mistake, cause
from exercises.rigid_body.public.quantities import Array
from polhode.judging.outcome import Diagnosis

AGREEMENT = 1e-10
NEARLY = 0.03
SINGLE, ROUNDING = 1e-6, 1e-12  # relative errors of single precision and of right moments
EDGES = ("a", "b", "c")
PAIRS = list(itertools.combinations_with_replacement(range(3), 2))
MASSLESS = "lacks the mass m"
EXTRA = "look for an extra factor"
FACTORS = {
    12.0: "the division by 12 is missing",
    4.0: "m/12 belongs to full edges, m/3 to half edges",
    2.0: "use m/12, not m/6",
    0.25: "m/12 goes with full edge lengths, so do not halve a, b and c",
    2.4: "m/5 belongs to the semi-axes of an ellipsoid",
    0.6: "m/20 belongs to the axes of an ellipsoid, m/12 to the edges of a box",
}


def causes_of_boxes(inputs: Inputs, moments: Array) -> list[Diagnosis]:
    """Return the causes for ``box_moments``, (n, 3) in kg m² for the boxes (m, a, b, c): an order, a
    convention, or its wrong terms.
    """
    boxes = np.asarray(inputs["boxes"], dtype=float)
    truth = np.array([reference.box_moments(*row) for row in boxes])
    if (found := _no_number(moments, truth, "box_moments")) or _same(moments, truth):
        return found
    constant = "box_moments returns the same numbers for every box{}: compute them from a, b and c"
    return (
        _constant(moments, constant.format(""))
        or _constant(moments / boxes[:, :1], constant.format(", times the mass"))
        or _first(_of_boxes(boxes, truth), moments)
        or (_nearly(moments, truth) if np.ptp(moments / truth, axis=0).max() > AGREEMENT else [])
        or _read(boxes, moments)
    )


def _of_boxes(boxes: Array, truth: Array) -> list[Mistake]:
    m, edges = boxes[:, :1], boxes[:, 1:]
    b, c = edges[:, [1, 0, 0]], edges[:, [2, 2, 1]]  # of I₁; of I₂: a and c; of I₃: a and b
    turned = edges[:, [1, 2, 0]], edges[:, [2, 0, 1]]  # of I₂: c and a
    volume = edges.prod(axis=1, keepdims=True)
    exchanged = np.array([reference.box_moments(row[3], *row[:3]) for row in boxes])
    belongs = "the first belongs to the edge a"
    orders = {
        ", ".join(MOMENT[k] for k in order): truth[:, order] for order in itertools.permutations(range(3))
    }
    brackets = [
        ("missing-brackets", f"I₁ is computed as {place}, and so on: (b² + c²) needs its brackets", value)
        for x, y in ((b**2, c**2), (turned[0] ** 2, turned[1] ** 2))
        for place, value in (
            ("m/12·b² + c²", m / 12 * x + y),
            ("b² + c²·m/12", x + m / 12 * y),
            ("m·b² + c²/12", m * x + y / 12),
        )
    ]
    return [
        *brackets,
        *(
            ("moment-order", f"the right moments in the wrong order: {k}; {belongs}", value)
            for k, value in orders.items()
        ),
        (
            "moment-order",
            f"the right moments, but sorted: {belongs}, whatever its size",
            np.sort(truth, axis=1),
        ),
        ("wrong-power", "the square roots of the moments instead of the moments", np.sqrt(truth)),
        ("wrong-quantity", "the inverse moments instead of the moments", 1 / truth),
        ("wrong-quantity", "the radii of gyration √(I/m) instead of the moments", np.sqrt(truth / m)),
        (
            "floor-division",
            "the moments are cut to whole numbers: look for floor division (//) or int",
            np.floor(truth),
        ),
        (
            "floor-division",
            "m is divided by 12 with //, which drops the fraction: use /",
            m // 12 * (b**2 + c**2),
        ),
        ("wrong-power", "the edges are not squared: I₁ has b + c instead of b² + c²", m / 12 * (b + c)),
        ("wrong-power", "I₁ has 2b + 2c instead of b² + c²: the square is b**2", m / 6 * (b + c)),
        (
            "wrong-power",
            "I₁ has the root of b² + c², and so on: look for np.hypot or a norm",
            m / 12 * np.hypot(b, c),
        ),
        (
            "wrong-quantity",
            "the right moments times the volume abc: m is the mass, not the density",
            truth * volume,
        ),
        (
            "wrong-quantity",
            "the right moments divided by the volume abc: m is the mass, not the density",
            truth / volume,
        ),
        (
            "swapped-arguments",
            "the arguments are taken as (a, b, c, m): box_moments is called as (m, a, b, c)",
            exchanged,
        ),
    ]


def causes_of_tensors(tensors: Array, moments: Array) -> list[Diagnosis]:
    """Return the causes for ``principal_moments``, (n, 3) in kg m², in any order, for the ``tensors`` (n, 3,
    3).
    """
    seen, truth = np.sort(moments, axis=1), reference.principal_moments(tensors)
    if (found := _no_number(seen, truth, "principal_moments")) or _same(seen, truth):
        return found
    if found := _first(_of_tensors(tensors, truth), seen):
        return found
    factor = float(np.sum(seen / truth) / seen.size)
    if (
        np.isfinite(factor)
        and _same(seen, factor * truth)
        and (len(truth) > 1 or f"{factor:.3g}" == f"{factor:.9g}")
    ):
        return [cause("constant-factor", f"{factor:.10g} times the right value: {EXTRA}")]
    _, axes = np.linalg.eigh(tensors)
    sizes = np.sort(np.abs(moments), axis=1)
    for vectors in (axes, np.swapaxes(axes, 1, 2)):
        if np.all(
            np.any(
                np.all(np.abs(np.sort(np.abs(vectors), axis=1) - sizes[:, :, None]) < 1e-6, axis=1), axis=1
            )
        ):
            return [
                cause(
                    "wrong-quantity",
                    "a principal axis (an eigenvector), not the moments: np.linalg.eigh returns both",
                )
            ]
    excess = np.cumsum(truth - seen, axis=1) / truth.max(axis=1, keepdims=True)
    if np.all(excess <= AGREEMENT) and np.all(
        np.abs(excess[:, 2]) <= AGREEMENT
    ):  # Schur and Horn: the diagonal of such a tensor
        unfinished = (
            "the sum is right, but the values are the diagonal of a tensor that is not diagonal yet: use"
            " np.linalg.eigvalsh"
        )
        return [cause("diagonal-only", unfinished)]
    shares = seen / np.trace(tensors, axis1=1, axis2=2)[:, None]
    return _nearly(seen, truth) or _constant(
        shares, "the same shares of the trace for every tensor: return its eigenvalues"
    )


def _of_tensors(tensors: Array, truth: Array) -> list[Mistake]:
    instead, quantity = "instead of the moments themselves", "wrong-quantity"
    diagonal, mean = np.diagonal(tensors, axis1=1, axis2=2), truth.mean(axis=1, keepdims=True)
    minors = np.array(
        [[np.linalg.det(tensor[:k, :k]) for k in range(4)] for tensor in tensors]
    )  # of size 0: 1
    upper = np.array([np.diagonal(np.linalg.qr(tensor)[1]) for tensor in tensors])
    factor = "this is the diagonal of a triangular factor, as from Gaussian elimination"
    triangular = f"{factor}; only the product is right: return the eigenvalues"
    second = (
        "these are the second moments of the mass, half the trace minus each moment: return the moments of"
        " inertia"
    )
    opposite = "the off-diagonal elements have the opposite sign: use the tensor as it is given"
    sizes = {"their length": np.linalg.norm(truth, axis=1), "their sum": truth.sum(axis=1)}
    sizes |= {"the largest": truth[:, 2], "the smallest": truth[:, 0], "the middle one": truth[:, 1]}
    rows = [
        ("diagonal-only", "the diagonal of the tensor: the principal moments are its eigenvalues", diagonal),
        (
            quantity,
            "the lengths of the eigenvectors, which are all 1: np.linalg.eigh returns the eigenvalues first",
            np.ones_like(truth),
        ),
        ("sign-reversed", "the opposite sign: moments of inertia are positive", -truth),
        (quantity, f"the square roots of the moments {instead}", np.sqrt(truth)),
        (quantity, f"the inverse moments {instead}", 1 / truth),
        (quantity, f"the squares of the moments {instead}", truth**2),
        (
            quantity,
            "every value is a third of the trace; only the sum is right: return the eigenvalues",
            0 * truth + mean,
        ),
        (
            quantity,
            "the lengths of the columns of the tensor: return its eigenvalues",
            np.linalg.norm(tensors, axis=1),
        ),
        (quantity, "the sums of the rows of the tensor: return its eigenvalues", tensors.sum(axis=1)),
        (
            "absolute-value",
            "the eigenvalues of the absolute values of the tensor: its signs are lost",
            np.linalg.eigvalsh(np.abs(tensors)),
        ),
        ("sign-flipped", opposite, np.linalg.eigvalsh(2 * diagonal[:, None] * np.eye(3) - tensors)),
        (quantity, second, 3 * mean / 2 - truth),
        *((quantity, triangular, values) for values in (minors[:, 1:] / minors[:, :3], upper, np.abs(upper))),
        *(
            ("normalised", f"the right moments divided by {name}", truth / size[:, None])
            for name, size in sizes.items()
        ),
        (
            "precision-loss",
            "the tensor is cut to whole numbers: look for an array of integers",
            np.linalg.eigvalsh(np.trunc(tensors)),
        ),
        ("precision-loss", "the moments are cut to whole numbers", np.trunc(truth)),
    ]
    return [(code, sentence, np.sort(values, axis=1)) for code, sentence, values in rows]


def _no_number(moments: Array, truth: Array, function: str) -> list[Diagnosis]:
    """Return the diagnosis if the moments (n, 3) are not finite, zero,
    or the right ones with fewer digits.
    """
    if not np.all(np.isfinite(moments)):
        return [cause("not-finite", f"{function} returns values that are not finite")]
    if not moments.any():
        return [cause("returns-zero", f"{function} returns zeros for all arguments")]
    slack = 4 * np.finfo(float).eps * np.abs(moments)
    for decimals in range(12):
        half = 0.5000001 * 10.0**-decimals + ROUNDING * truth.max(axis=1, keepdims=True)
        if np.all(
            (np.abs(moments - np.round(moments, decimals)) <= slack) & (np.abs(moments - truth) <= half)
        ):
            return [cause("precision-loss", f"the moments are rounded to {decimals} decimals")]
    single = np.array_equal(moments, moments.astype(np.float32)) and np.all(
        np.abs(moments / truth - 1) < SINGLE
    )
    return [cause("precision-loss", "the moments are in single precision (float32)")] if single else []


def _first(mistakes: list[Mistake], moments: Array) -> list[Diagnosis]:
    return next(
        ([cause(code, sentence)] for code, sentence, values in mistakes if _same(moments, values)), []
    )


def _constant(values: Array, sentence: str) -> list[Diagnosis]:
    """Return the diagnosis if the rows of ``values`` (n, 3) are all the same."""
    same = len(values) > 1 and _same(values, np.broadcast_to(values[0], values.shape))
    return [cause("hard-coded-moments", sentence)] if same else []


def _nearly(moments: Array, truth: Array, how: str = "within {:.2g} of the right moments") -> list[Diagnosis]:
    off = float(np.abs(moments / truth - 1).max())
    sentence = (
        f"nearly right: {how.format(off)}: use the closed formula or np.linalg.eigvalsh instead of a"
        " numerical approximation"
    )
    return [cause("nearly-right", sentence, 0.8)] if off <= NEARLY else []


def _read(boxes: Array, moments: Array) -> list[Diagnosis]:
    """Return the errors in the moments' terms: weights of the squared edges and their products, with or
    without the mass; none if a moment has other terms.
    """
    mass, edges = boxes[:, 0], boxes[:, 1:]
    squares = np.column_stack([edges[:, a] * edges[:, b] for a, b in PAIRS]) / 12
    terms = {"": squares * mass[:, None], MASSLESS: squares}
    fitted = sums(terms, moments, mass * (edges**2).sum(axis=1), agreement=AGREEMENT)
    if not all(fitted):
        return []
    massless, found = [], list[Diagnosis]()
    for k, ((lacks, weights), *_) in enumerate(fitted):
        massless += [cause("missing-term", f"{MOMENT[k]} {lacks}")] if lacks and any(weights) else []
        found += _weighed(dict(zip(PAIRS, weights, strict=True)), k)
    missing = [cause("missing-term", "the moments lack the mass m")] if len(massless) == 3 else massless
    return list(dict.fromkeys([*missing, *found]))


def _weighed(weights: dict[tuple[int, int], float], k: int) -> list[Diagnosis]:
    i, j = sorted({0, 1, 2} - {k})
    due, used = {(i, i), (j, j)}, {pair for pair, weight in weights.items() if weight}
    if not used:
        return [cause("missing-component", f"{MOMENT[k]} is always zero")]
    first, second, right = weights[i, i], weights[j, j], f"{EDGES[i]}² + {EDGES[j]}²"
    if used != due:
        has = " + ".join(f"{EDGES[a]}²" if a == b else f"{EDGES[a]}{EDGES[b]}" for a, b in sorted(used))
        code = (
            "missing-term" if used < due else "cyclic-order" if all(a == b for a, b in used) else "extra-term"
        )
        return [cause(code, f"{MOMENT[k]} has {has} instead of {right}")]
    if np.isclose(first, -second, rtol=1e-9):
        return [cause("sign-flipped", f"{MOMENT[k]} has {EDGES[i]}² − {EDGES[j]}² instead of {right}")]
    if not np.isclose(first, second, rtol=1e-9):
        factors = f"{first:.6g} for {EDGES[i]}² and {second:.6g} for {EDGES[j]}²"
        return [
            cause(
                "constant-factor",
                f"{MOMENT[k]} has the factors {factors}, in units of m/12, instead of 1 and 1",
            )
        ]
    if np.isclose(first, 1, rtol=1e-9):
        return []
    hint = FACTORS.get(round(first, 9), EXTRA)
    nearly = _nearly(np.array([first]), np.array([1.0]), f"{first:.6g} times the right value")
    return nearly or [cause("constant-factor", f"{first:.10g} times the right value: {hint}")]


def _same(seen: Array, expected: Array) -> bool:
    """Return whether all moments (n, 3) agree, each to rounding of its body's largest moment."""
    return bool(np.all(np.abs(seen - expected) <= AGREEMENT * np.abs(expected).max(axis=1, keepdims=True)))
