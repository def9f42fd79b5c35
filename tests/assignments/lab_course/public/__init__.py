"""The exercises of the lab course."""

from polhode.judging.checks import close
from polhode.judging.exercise import Exercise


def _number(id, label, scene, name="value"):
    return close(
        id,
        label,
        scene,
        measured=lambda seen: seen[name],
        expected=lambda truth: truth[name],
        rtol=1e-12,
        atol=1e-12,
        reason="a few operations with small whole numbers",
    )


EXERCISES = (
    Exercise("1", "A model", ("model",), (_number("1-line", "the model is 2x", "line", "y"),)),
    Exercise(
        "2",
        "A fit",
        ("residual", "total"),
        (
            _number("2-misfit", "the misfit of the model", "misfit"),
            _number("2-sum", "the sum of both files", "sum"),
        ),
    ),
    Exercise(
        "3",
        "Values",
        ("slope", "settings"),
        (_number("3-slope", "the slope", "slope"), _number("3-g", "the setting g", "settings")),
        variables=("slope", "settings"),
    ),
    Exercise("4", "A class", ("Pendulum",), (_number("4-steps", "three steps", "steps"),)),
)
