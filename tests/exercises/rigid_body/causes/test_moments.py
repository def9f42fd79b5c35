"""Wrong moments of boxes and tensors get their code, whatever the size of the box."""

import numpy as np
import pytest

from exercises.rigid_body.causes import diagnose_function, diagnose_scene
from service.grading.jobs import draw_inputs

BOXES = {
    "4 * I": ("constant-factor", "m/3 to half edges"),
    "2 * I": ("constant-factor", "not m/6"),
    "I / 4": ("constant-factor", "do not halve"),
    "I * 12 / 5": ("constant-factor", "ellipsoid"),
    "I / m": ("missing-term", "lack the mass m"),
    "I[::-1]": ("moment-order", "I₃, I₂, I₁"),
    "np.sort(I)": ("moment-order", "sorted"),
    "np.sqrt(I)": ("wrong-power", "square roots"),
    "I // 1": ("floor-division", "whole numbers"),
    "np.array([m / 12 * b * b + c * c, m / 12 * c * c + a * a, m / 12 * a * a + b * b])": (
        "missing-brackets",
        "m/12·b² + c²",
    ),
    "np.array([m / 12 * b * b + c * c, m / 12 * a * a + c * c, m / 12 * a * a + b * b])": (
        "missing-brackets",
        "m/12·b² + c²",
    ),
    "np.array([I[0], m / 12 * (3 * a * a + c * c), I[2]])": (
        "constant-factor",
        "I₂ has the factors 3 for a² and 1 for c²",
    ),
    "np.array([b * 2 + c * 2, a * 2 + c * 2, a * 2 + b * 2]) * m / 12": ("wrong-power", "b**2"),
    "np.array([0.1, 0.2, 0.25])": ("hard-coded-moments", "same numbers for every box:"),
    "np.array([0.1, 0.2, 0.25]) * m": ("hard-coded-moments", "for every box, times the mass:"),
    "np.round(I, 3)": ("precision-loss", "rounded to 3 decimals"),
    "np.float32(I)": ("precision-loss", "single precision"),
    "I * (1 + 0.01 * np.sin(m + a))": ("nearly-right", "within 0.01 of the right moments"),
    "I * (1 - 1 / 50**2)": ("nearly-right", "0.9996 times the right value"),
    "np.array([a * a, b * b, c * c]) * m / 12": ("cyclic-order", "I₁ has a² instead of"),
    "np.array([(b + c) ** 2, (a + c) ** 2, (a + b) ** 2]) * m / 12": ("extra-term", "bc"),
}
TENSORS = {
    "np.diag(T)": ("diagonal-only", "diagonal"),
    "np.linalg.eigh(T)[1][:, 0]": ("wrong-quantity", "eigenvector"),
    "np.linalg.eigh(T)[1][1]": ("wrong-quantity", "eigenvector"),
    "np.sqrt(e)": ("wrong-quantity", "square roots"),
    "e ** 2": ("wrong-quantity", "squares"),
    "1 / e": ("wrong-quantity", "inverse"),
    "-e": ("sign-reversed", "positive"),
    "np.linalg.eigvalsh(2 * np.diag(np.diag(T)) - T)": ("sign-flipped", "off-diagonal elements"),
    "np.linalg.eigvalsh(np.trace(T) / 2 * np.eye(3) - T)": ("wrong-quantity", "half the trace"),
    "np.diag(np.linalg.cholesky(T)) ** 2": ("wrong-quantity", "triangular factor"),
    "np.diag(np.linalg.qr(T)[1])": ("wrong-quantity", "triangular factor"),
    "e / np.linalg.norm(e)": ("normalised", "their length"),
    "e / e[0]": ("normalised", "the smallest"),
    "np.full(3, np.trace(T) / 3)": ("wrong-quantity", "third of the trace"),
    "np.linalg.norm(T, axis=0)": ("wrong-quantity", "columns"),
    "T.sum(axis=1)": ("wrong-quantity", "rows"),
    "np.linalg.norm(np.linalg.eigh(T)[1], axis=0)": ("wrong-quantity", "all 1"),
    "qr_steps(T, 3)": ("diagonal-only", "not diagonal yet"),
    "np.linalg.eigvalsh(T - 1e-3 * np.diag(np.diag(T)))": ("nearly-right", "nearly right: within 0.00"),
    "e.round(10)": ("precision-loss", "rounded to 10 decimals"),
    "np.float32(e)": ("precision-loss", "single precision"),
    "3 * e": ("constant-factor", "3 times"),
}


def qr_steps(tensor, steps):
    for _ in range(steps):
        q, r = np.linalg.qr(tensor)
        tensor = r @ q
    return np.diag(tensor)


def box(answer, row):
    m, a, b, c = row
    I = m / 12 * np.array([b * b + c * c, a * a + c * c, a * a + b * b])
    return eval(answer, {"np": np, "m": m, "a": a, "b": b, "c": c, "I": I})


def causes(given, moments):
    return diagnose_function(
        "principal_moments", {"tensors": (given, {"moments": np.array(moments, dtype=float)})}
    )


@pytest.mark.parametrize("answer", BOXES)
def test_boxes(answer, rigid_body):
    code, said = BOXES[answer]
    given = draw_inputs(rigid_body.scene("boxes"), 4)
    found = diagnose_scene(
        "boxes", given, {"moments": np.array([box(answer, row) for row in given["boxes"]])}
    )
    assert {cause.code for cause in found} == {code} and any(said in cause.sentence for cause in found)


@pytest.mark.parametrize("scene", ["tensor", "tensors"])
@pytest.mark.parametrize("answer", TENSORS)
def test_tensors(answer, scene, rigid_body):
    code, said = TENSORS[answer]
    given = draw_inputs(rigid_body.scene(scene), 4)
    tensors = [np.asarray(T) for T in given["tensors"]]
    answers = [
        eval(answer, {"np": np, "qr_steps": qr_steps, "T": T, "e": np.linalg.eigvalsh(T)}) for T in tensors
    ]
    found = causes(given, np.array(answers))
    assert [cause.code for cause in found] == [code] and said in found[0].sentence


def test_fixed_shares_of_the_trace(rigid_body):
    tensors = np.asarray(draw_inputs(rigid_body.scene("tensors"), 4)["tensors"])
    (cause,) = causes({"tensors": tensors}, np.trace(tensors, axis1=1, axis2=2)[:, None] * [0.1, 0.4, 0.5])
    assert cause.code == "hard-coded-moments" and "shares of the trace" in cause.sentence


def test_eigenvalues_of_absolute_values(rigid_body):
    given = draw_inputs(rigid_body.scene("tensors"), 4)
    (cause,) = causes(given, np.linalg.eigvalsh(np.abs(given["tensors"])))
    assert cause.code == "absolute-value"


def test_right_or_unknown_moments_have_no_cause(rigid_body):
    boxes, tensors = (draw_inputs(rigid_body.scene(name), 4) for name in ("boxes", "tensors"))
    right = np.array([box("I", row) for row in boxes["boxes"]])
    assert diagnose_scene("boxes", boxes, {"moments": right}) == []
    assert diagnose_scene("boxes", boxes, {"moments": right * (1 + 0.1 * np.sin(right))}) == []
    e = np.linalg.eigvalsh(tensors["tensors"])
    assert causes(tensors, e[:, ::-1]) == []
    assert causes(tensors, e * (1 + 0.1 * np.sin(e))) == []
