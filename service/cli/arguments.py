"""Arguments that several commands have."""

import argparse
from collections.abc import Callable
from typing import TypeVar

Number = TypeVar("Number", int, float)


def number(kind: type[Number], test: Callable[[Number], bool], *, detail: str) -> Callable[[str], Number]:
    """Return a function for argparse that reads a number for which ``test`` is true; ``detail`` says what is
    expected.
    """

    def read(text: str) -> Number:
        if not test(value := kind(text)):
            raise argparse.ArgumentTypeError(f"{detail}, got {text}")
        return value

    read.__name__ = kind.__name__  # argparse names it where the text is no number
    return read


count = number(int, lambda n: n >= 1, detail="expected at least 1")
seed = number(int, lambda n: n >= 0, detail="expected a seed of 0 or more")


def add_exercise(parser: argparse.ArgumentParser) -> None:
    """Add the option that selects exercises."""
    parser.add_argument(
        "--exercise",
        action="append",
        metavar="N",
        help="grade exercise N; repeatable; default: the attempted exercises",
    )
