"""Wrong versions of ``euler_eqs``: single mistakes, random pairs of them, and the variants of right samples.

``polhode mutants`` grades them all. ``differs`` decides independently of the checks that they are wrong.
"""

import contextlib
import itertools
import random
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import reference
from exercises.catalogue import find
from exercises.mutation import variants
from exercises.solution import Variant

W, I = ("w[0]", "w[1]", "w[2]"), ("I[0]", "I[1]", "I[2]")
PAIRS = 60
SAMPLES = (
    "right_terms.py",
    "right_cross.py",
    "right_roll.py",
    "right_skew_matrix.py",
    "right_einsum_levi_civita.py",
    "right_inverse_tensor.py",
    "right_loop_modulo.py",
)
EXERCISES = ("2", "3", "4", "5")
LINES = {
    "the notebook's two checks of exercise 2": frozenset(["2-energy", "2-momentum"]),
    "the notebook's seven checks": frozenset(
        ["2-energy", "2-momentum", "3-energy", "3-momentum", "4-constant", "4-rate", "5-notebook"]
    ),
}
POINTS, ROUNDING, PATIENCE = 400, 1e-11, 5


def mutants() -> Iterator[Variant]:
    """Yield all mutants in a fixed order."""
    slips = [slip for k in range(3) for slip in _component_slips(k)]
    for name, k, term in slips:
        yield Variant("one mistake in one component", name, _function({k: term}))
    rng = random.Random(2026)  # noqa: S311
    pairs = [(a, b) for a, b in itertools.combinations(slips, 2) if a[1] != b[1]]
    for (first, k, one), (second, m, other) in rng.sample(pairs, PAIRS):
        yield Variant("two mistakes", f"{first}; {second}", _function({k: one, m: other}))
    yield from _whole()
    folder = Path(__file__).parent / "samples"
    for file in SAMPLES:
        for variant in variants((folder / file).read_text()):
            yield Variant(variant.code, f"{file} line {variant.line}: {variant.sentence}", variant.source)


def differs(source: str) -> bool:
    """Return whether the function is not Euler's equations to rounding, at its own points: bodies and spins
    of all sizes.
    """
    rng = np.random.default_rng(7)
    boxes = 10 ** rng.uniform(-1.5, 1.5, (POINTS, 3))
    moments = np.array([reference.box_moments(1.0, *box) for box in boxes])
    spins = rng.normal(size=(POINTS, 3)) * 10 ** rng.uniform(-3.0, 3.0, (POINTS, 1))
    names: dict[str, Any] = {}
    exec(find("rigid-body").setup, names)
    before = signal.signal(signal.SIGALRM, _ring)
    signal.alarm(PATIENCE)
    try:
        with np.errstate(all="ignore"), contextlib.redirect_stdout(None):
            exec(source, names)
            return any(_differs_at(names["euler_eqs"], w, I) for w, I in zip(spins, moments, strict=True))
    except Exception:
        return True
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def _ring(signum: int, frame: Any) -> None:
    raise TimeoutError


def _differs_at(function: Any, w: Any, I: Any) -> bool:
    size = np.abs(I).max() * np.abs(w).max() ** 2 / I
    answer = np.asarray(function(float(w[0]), w.copy(), I.copy()), dtype=float)
    return answer.shape != (3,) or not bool(np.all(np.abs(answer - reference.euler_rhs(w, I)) <= ROUNDING * size))


def _right(k: int) -> str:
    i, j = (k + 1) % 3, (k + 2) % 3
    return f"({I[i]} - {I[j]}) * {W[i]} * {W[j]} / {I[k]}"


def _component_slips(k: int) -> Iterator[tuple[str, int, str]]:
    i, j = (k + 1) % 3, (k + 2) % 3
    c = f"component {k + 1}: "
    yield c + "sign", k, f"-({_right(k)})"
    yield c + "zero", k, "0.0 * w[0]"
    for name, factor in (("doubled", "2"), ("halved", "0.5"), ("off by 1e-6", "(1 + 1e-6)"), ("off by 1e-9", "(1 + 1e-9)")):
        yield c + name, k, f"{factor} * ({_right(k)})"
    for product in itertools.combinations_with_replacement(range(3), 2):
        if product != tuple(sorted((i, j))):
            a, b = product
            yield c + f"ω{a + 1}ω{b + 1}", k, f"({I[i]} - {I[j]}) * {W[a]} * {W[b]} / {I[k]}"
    for a, b in itertools.permutations(range(3), 2):
        if (a, b) not in ((i, j), (j, i)):
            yield c + f"I{a + 1} − I{b + 1}", k, f"({I[a]} - {I[b]}) * {W[i]} * {W[j]} / {I[k]}"
    yield c + "sum of moments", k, f"({I[i]} + {I[j]}) * {W[i]} * {W[j]} / {I[k]}"
    yield c + "one moment", k, f"{I[i]} * {W[i]} * {W[j]} / {I[k]}"
    for divisor in (I[i], I[j], "1.0", f"{I[k]} ** 2", "I.sum()", f"(1 / {I[k]})"):
        yield c + f"over {divisor}", k, f"({I[i]} - {I[j]}) * {W[i]} * {W[j]} / {divisor}"
    for term in (f"0.01 * {W[k]}", "0.01", f"1e-6 * {W[k]}", "0.01 * t", f"1e-9 * {W[k]} ** 2"):
        yield c + f"extra {term}", k, f"({_right(k)}) - {term}"


def _whole() -> Iterator[Variant]:
    right = "np.array([" + ", ".join(_right(k) for k in range(3)) + "])"
    whole = {
        "zeros": "np.zeros(3)",
        "reversed in time": f"-{right}",
        "w itself": "1.0 * w",
        "all doubled": f"2 * {right}",
        "not divided": f"{right} * I",
        "divided twice": f"{right} / I",
        "single precision": f"{right}.astype(np.float32)",
        "rounded to 9 places": f"np.round({right}, 9)",
        "one divisor for all": f"{right} * I / I.mean()",
    }
    for order in itertools.permutations(range(3)):
        if order != (0, 1, 2):
            whole[f"components in the order {order}"] = f"{right}[list({order})]"
            whole[f"moments in the order {order}"] = f"(lambda I: {right})(I[list({order})])"
    whole["moments sorted"] = f"(lambda I: {right})(np.sort(I))"
    for body in ((2.0, 3.0, 4.0), (1.0, 1.0, 1.6)):
        whole[f"always I = {body}"] = f"(lambda I: {right})(np.array({body}))"
    for name, answer in whole.items():
        yield Variant("a mistake in all components", name, f"def euler_eqs(t, w, I):\n    return {answer}\n")


def _function(changed: dict[int, str]) -> str:
    terms = ", ".join(changed.get(k, _right(k)) for k in range(3))
    return f"def euler_eqs(t, w, I):\n    return np.array([{terms}])\n"
