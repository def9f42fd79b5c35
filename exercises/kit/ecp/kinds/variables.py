"""The kind "variables": numbers and arrays that a cell assigns, each by its value, and claims about several of them."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ecp.checks import Arrays, Check, shows
from ecp.kinds.asking import evaluate, returned, stacked
from ecp.kinds.values import value_check
from ecp.return_value import WrongAnswer


def play(question: Mapping[str, Any], student: Mapping[str, Any], rows: Mapping[str, Any]) -> dict[str, Any]:
    """Return the variables by name, as one row. Raises WrongAnswer."""
    found: dict[str, Any] = {}
    for value in question["returns"]:
        name = value["name"]
        try:
            found |= returned({"function": name, "returns": [value]}, student[name])
        except WrongAnswer as error:
            shape = f"an array of shape {tuple(value['shape'])}" if value["shape"] else "a number"
            raise WrongAnswer(error.code, f"{name} must be {shape}; it is {_described(student[name])}") from None
    return stacked([found])


def _described(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape} and dtype {value.dtype}"
    return str(value) if isinstance(value, float) else f"of type {type(value).__name__}"


def checks(question: Mapping[str, Any], scene: str, suffix: str) -> list[Check]:
    """Return one check for each variable with an exact value, and one for each claim."""
    id, compared = question["id"], [value for value in question["returns"] if value["name"] in question["compared"]]
    found = [value_check({**question, "drawn": []}, value, scene, f"{id}-{value['name']}", suffix) for value in compared]
    return found + [_claim(claim, scene, f"{id}-claim-{k}") for k, claim in enumerate(question["claims"], 1)]


def _claim(claim: Mapping[str, Any], scene: str, id: str) -> Check:
    def holds(seen: Arrays, truth: Arrays) -> tuple[bool, str]:
        values = {name: seen[name][0] for name in claim["names"]}
        shown = (f"{name} = {np.array2string(value, precision=6, threshold=12, separator=', ')}" for name, value in values.items())
        return bool(np.all(evaluate(claim["text"], values))), ", ".join(" ".join(text.split()) for text in shown)

    return shows(id, claim["label"], scene, claim=holds, reason=claim["reason"])
