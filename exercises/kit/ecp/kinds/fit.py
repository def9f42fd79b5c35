"""The kind "fit": parameters of a fit and their covariance, compared in units of the exact standard deviations."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ecp import judge
from ecp.checks import Arrays, Check
from ecp.judge import Judgement
from ecp.kinds.values import credited, play  # noqa: F401
from ecp.outcome import Tolerance


def checks(question: Mapping[str, Any], scene: str, suffix: str) -> list[Check]:
    """Return the check of the parameters and that of the covariance."""
    id, parameters = question["id"] + ("-new" if suffix else ""), question["fitted"]

    def locate(index: tuple[int, ...], seen: Arrays) -> str:
        return f"data set {index[0] + 1}, {' and '.join(dict.fromkeys(parameters[k] for k in index[1:]))}"

    return [
        Check(
            f"{id}-{value['name']}",
            value["label"] + suffix,
            (scene,),
            _word(value),
            Tolerance(**value["tolerance"]),
            locate,
            points=value.get("points", 1),
        )
        for value in question["returns"]
    ]


def _word(value: Mapping[str, Any]) -> Any:
    name, limit = value["name"], value["tolerance"]["limit"]

    def word(seen: list[Arrays], truth: list[Arrays]) -> Judgement:
        deviation = np.sqrt(np.einsum("rii->ri", truth[0]["covariance"]))
        scale = deviation if name == "parameters" else deviation[:, :, None] * deviation[:, None, :]
        got, want = seen[0][name], truth[0][name]
        return credited(value, lambda given: judge.within(given, want, scale, limit), got, want)

    return word
