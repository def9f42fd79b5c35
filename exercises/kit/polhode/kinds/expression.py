"""The kind "expression": a sympy expression, by its values at points. Only numbers leave the student's
process.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from polhode.judging.return_value import WrongAnswer, article
from polhode.kinds.student_calls import arguments, call, each, parts, returned
from polhode.kinds.values import checks  # noqa: F401

DIGITS = 30  # of the evaluation, so that cancellation in an equivalent form costs nothing


def play(question: Mapping[str, Any], student: Mapping[str, Any], rows: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values of the student's expressions at the point of each row. Raises WrongAnswer."""
    found: dict[str, list[Any]] = {}  # by the arguments that are not symbols: a call may take long

    def answer(row: Mapping[str, Any]) -> dict[str, Any]:
        given = {name: value for name, value in row.items() if name not in question["symbols"]}
        if (key := repr(given)) not in found:
            answered = parts(question, call(question, student, arguments(question, row)))
            found[key] = [_table(part, question["function"]) for part in answered]
        point = {
            name: complex(*value) if np.ndim(value) else value
            for name, value in row.items()
            if name in question["symbols"]
        }
        values = [_evaluated(table, point, question["function"]) for table in found[key]]
        return returned(question, values if len(values) > 1 else values[0], alone=True)

    return each(rows, answer)


def _table(value: Any, name: str) -> Any:
    """Return an expression, a matrix or a list of expressions as an array of expressions of its own, or the
    WrongAnswer that it is.
    """
    if isinstance(value, WrongAnswer):
        return value
    if value is None:
        return WrongAnswer("returns-nothing", f"{name} returned None: is a return statement missing?")
    return np.array(value.tolist() if hasattr(value, "tolist") else value, dtype=object)


def _evaluated(table: Any, point: Mapping[str, complex], name: str) -> Any:
    """Return the numbers of expressions at a point, by the names of its symbols, or why there are none."""
    if isinstance(table, WrongAnswer):
        return table
    try:
        return np.array([_number(part, point, name) for part in table.flat], dtype=complex).reshape(
            table.shape
        )
    except WrongAnswer as error:
        return error


def _number(part: Any, point: Mapping[str, complex], name: str) -> complex:
    import sympy

    try:
        expression = sympy.sympify(part, strict=True)
    except sympy.SympifyError:
        raise WrongAnswer(
            None, f"{name} must be a sympy expression; it is {article(type(part).__name__)}"
        ) from None
    if not isinstance(expression, sympy.Expr):
        raise WrongAnswer(None, f"{name} must be a sympy expression; it is {article(type(part).__name__)}")
    if unknown := sorted({symbol.name for symbol in expression.free_symbols} - set(point)):
        raise WrongAnswer(
            None, f"{name} contains {', '.join(unknown)}; it may contain only {', '.join(point)}"
        )
    symbols = {symbol: _exactly(point[symbol.name]) for symbol in expression.free_symbols}
    for simpler in (lambda: expression, expression.doit):
        if (form := simpler()).has(sympy.Sum, sympy.Product):  # sympy's numbers of a series are unreliable
            continue
        try:
            value = complex(form.subs(symbols).evalf(DIGITS))
        except (TypeError, ValueError):
            continue
        if np.isfinite(value):
            return value
    at = ", ".join(f"{key} = {value:.6g}" for key, value in point.items())
    raise WrongAnswer(None, f"{name} has no value at {at}: {str(expression)[:200]}")


def _exactly(value: complex) -> Any:
    """Return a number as sympy's, with digits to spare."""
    import sympy

    real, imaginary = (sympy.Float(part, 2 * DIGITS) for part in (complex(value).real, complex(value).imag))
    return real + sympy.I * imaginary if imaginary else real
