"""Linear fits that reproduce every number to rounding."""

from collections.abc import Hashable, Mapping
from typing import TypeVar

import numpy as np

from exercises.rigid_body.public.diagnosis import AGREEMENT
from exercises.rigid_body.public.quantities import Array

Label = TypeVar("Label", bound=Hashable)
LEAST_POINTS = 10  # a fit to fewer points is not conclusive


def sums(
    terms: Mapping[Label, Array],
    columns: Array,
    size: Array,
    slack: Array | float = 0.0,
    agreement: float = AGREEMENT,
) -> list[list[tuple[Label, list[float]]]]:
    """Return for each of the ``columns`` (n, m) label and weights of every sum of a label's ``terms`` (n,
    number) that gives it to ``agreement``. Weights that vanish are 0.

    The fit divides each point by its ``size`` (n,). Points of infinite size only confirm it, to ten times the
    agreement and ``slack`` (n,).
    """
    found: list[list[tuple[Label, list[float]]]] = [[] for _ in columns.T]
    rows, digits = np.flatnonzero(np.isfinite(size)), round(-np.log10(10 * agreement))
    if len(rows) < LEAST_POINTS:
        return found
    designs, labels = np.array(list(terms.values())), list(terms)
    scaled, due = designs[:, rows] / size[rows, None], columns[rows] / size[rows, None]
    fitted = np.linalg.pinv(scaled) @ due
    off = np.abs(scaled @ fitted - due).max(axis=1)
    for cell, m in np.argwhere(off <= agreement * np.abs(due).max(axis=0)):
        share = np.abs(scaled[cell] * fitted[cell, :, m]).max(axis=0)
        weights = np.where(share > agreement * share.max(), fitted[cell, :, m], 0.0)
        parts = designs[cell] * weights
        if np.all(
            np.abs(parts.sum(axis=1) - columns[:, m]) <= 10 * agreement * np.abs(parts).sum(axis=1) + slack
        ):
            found[m].append((labels[cell], [float(f"{weight:.{digits}g}") for weight in weights]))
    return found
