"""The kind "variables": numbers and arrays that a cell assigns, each by its value, and claims about several
of them.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from polhode.judging.checks import Arrays, Check, shows
from polhode.kinds.student_calls import evaluate
from polhode.kinds.values import play, value_check  # noqa: F401


def checks(question: Mapping[str, Any], scene: str, suffix: str) -> list[Check]:
    """Return one check for each variable with an exact value, and one for each claim."""
    compared = [value for value in question["returns"] if value["name"] in question["compared"]]
    found = [value_check(question, value, scene, suffix) for value in compared]
    return found + [
        _claim(claim, scene, f"{question['id']}-claim-{k}") for k, claim in enumerate(question["claims"], 1)
    ]


def _claim(claim: Mapping[str, Any], scene: str, id: str) -> Check:
    def holds(seen: Arrays, truth: Arrays) -> tuple[bool, str]:
        values = {name: seen[name][0] for name in claim["names"]}
        shown = (
            f"{name} = {np.array2string(value, precision=6, threshold=12, separator=', ')}"
            for name, value in values.items()
        )
        return bool(np.all(evaluate(claim["text"], values))), ", ".join(
            " ".join(text.split()) for text in shown
        )

    return replace(
        shows(id, claim["label"], scene, claim=holds, reason=claim["reason"]), arrays=tuple(claim["names"])
    )
