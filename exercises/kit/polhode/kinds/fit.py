"""The kind "fit": parameters of a fit and their covariance, compared in units of the exact standard
deviations.
"""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from polhode.judging.checks import Arrays, Check
from polhode.kinds.values import play, value_check  # noqa: F401


def checks(question: Mapping[str, Any], scene: str, suffix: str) -> list[Check]:
    """Return the check of the parameters and that of the covariance."""
    fitted = question["fitted"]

    def locate(index: tuple[int, ...], seen: Arrays) -> str:
        return f"data set {index[0] + 1}, {' and '.join(dict.fromkeys(fitted[k] for k in index[1:]))}"

    return [
        value_check(question, value, scene, suffix, scale=partial(_deviations, value["name"]), locate=locate)
        for value in question["returns"]
    ]


def _deviations(name: str, truth: Arrays) -> Any:
    """Return the exact standard deviations of the parameters, or the products of two of them for the
    covariance.
    """
    deviation = np.sqrt(np.einsum("rii->ri", truth["covariance"]))
    return deviation if name == "parameters" else deviation[:, :, None] * deviation[:, None, :]
