"""Wrong versions of a right solution: each changes one place of its source and says so in a sentence."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from exercises.equivalence import fingerprint
from exercises.solution import PRODUCT, SUM, Change, Solution, called, integer, is_operation

CODES = (
    *("sign-flipped", "missing-term", "wrong-index", "missing-brackets", "constant-factor", "missing-division", "wrong-divisor"),
    *("wrong-power", "wrong-function", "swapped-arguments", "missing-argument", "off-by-one", "wrong-option", "wrong-operator"),
    *("wrong-comparison", "component-order", "transposed", "wrong-constant", "wrong-variable"),
)
"""The diagnosis codes of variants, described in docs/checks.md."""
ALIKE = (
    "sin,cos;sinh,cosh;arcsin,arccos;asin,acos;min,max;minimum,maximum;argmin,argmax;floor,ceil;sum,mean;var,std;fft,ifft;"
    "real,imag;log,log10;zeros,ones;dot,cross;cumsum,cumprod;deg2rad,rad2deg"
)
IN_PLACE_OF = {a: b for pair in ALIKE.split(";") for a, b in (pair.split(","), pair.split(",")[::-1])}
DROPPED = "sqrt,exp,log,abs,absolute,conj,conjugate,real,floor,int,round,inv,sort,cumsum,radians,deg2rad,fftshift,unwrap"
COMMUTATIVE = "min,max,minimum,maximum,hypot,allclose,isclose,isinstance,zip,range"
OPERATORS = {ast.Mult: "* /", ast.Div: "/ *", ast.FloorDiv: "// /", ast.Mod: "% //", ast.Pow: "** *", ast.MatMult: "@ *"}
COMPARED = {ast.Lt: "< > <=", ast.LtE: "<= >= <", ast.Gt: "> < >=", ast.GtE: ">= <= >", ast.Eq: "== !=", ast.NotEq: "!= =="}
ASSIGNED = {ast.Add: "+= =", ast.Sub: "-= =", ast.Mult: "*= /=", ast.Div: "/= *="}


@dataclass(frozen=True)
class Variant:
    """A wrong version of a right solution.

    ``code``: one of ``CODES``. ``sentence``: what a student with this version did. ``source``: the
    whole changed source. ``line``: the changed line.
    """

    code: str
    sentence: str
    source: str
    line: int


def variants(source: str, function: str) -> list[Variant]:
    """Return the wrong versions of ``function``, which ``source`` defines, in the order of its lines.

    They change what the function uses of the source, other than imports. No version equals the source
    or another version up to rules of arithmetic; of equal ones the most common mistake stays.

    Raises SyntaxError if the source is not valid Python.
    """
    solution = Solution(source, function)
    seen, found = {fingerprint(solution.tree)}, []
    for change in (c for rule in RULES for node in solution.nodes for c in rule(solution, node)):
        text = solution.changed(change)
        if text is not None and (key := fingerprint(ast.parse(text))) not in seen:
            seen.add(key)
            found.append(Variant(change.code, change.sentence, text, solution.bytes.count(b"\n", 0, change.span[0]) + 1))
    return sorted(found, key=lambda variant: variant.line)


def _terms(s: Solution, node: Any) -> Iterator[Change]:
    if is_operation(node, *SUM):
        minus = is_operation(node, ast.Sub)
        left, right, opposite = node.left, node.right, "{} + {}" if minus else "{} - {}"
        yield s.change("sign-flipped", f"{s.term(right)} has the opposite sign", node, opposite, left, right, at=right)
        if minus:
            yield s.change("sign-flipped", f"{s.quote(node)} has the opposite sign", node, "{} - {}", right, left)
        yield s.change("missing-term", f"{s.term(right)} is missing", node, "{}", left, at=right)
        if not is_operation(left, *SUM):
            yield s.change("missing-term", f"{s.term(left)} is missing", node, "-{}" if minus else "{}", right, at=left)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub) and not isinstance(node.operand, ast.Constant):
        whole = s.product(node)
        yield s.change("sign-flipped", f"{s.term(whole)} has the opposite sign", node, "{}", node.operand, at=whole)
    elif isinstance(node, ast.AugAssign) and isinstance(node.op, SUM):
        new = "{} -= {}" if isinstance(node.op, ast.Add) else "{} += {}"
        what = f"{s.term(node.value)} has the opposite sign"
        yield s.change("sign-flipped", what, node, new, node.target, node.value, at=node.value, exact=True)
    elif s.is_term(node) and not s.text(node).startswith("-"):
        yield s.change("sign-flipped", f"{s.term(node)} has the opposite sign", node, "-{}", node)


def _indices(s: Solution, node: Any) -> Iterator[Change]:
    if not isinstance(node, ast.Subscript):
        return
    indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
    bounds = [b for i in indices if isinstance(i, ast.Slice) for b in (i.lower, i.upper, i.step) if b is not None]
    for part in (*indices, *bounds):
        value = integer(part)
        others: list[Any] = [value + 1, value - 1] if value else [1] if value == 0 else []
        if part in bounds:
            others = ["", *(other for other in others if other != 0)]
        elif isinstance(part, ast.Name):
            others = [f"{part.id} - 1", f"{part.id} + 1"]
        elif value == -1:
            others = [-2]
        for other in others:
            yield s.stands("wrong-index", part, str(other), node)
    if len(indices) == 2 and isinstance(node.ctx, ast.Load):
        what = f"the indices of {s.quote(node)} are exchanged"
        yield s.change("wrong-index", what, indices[0], "{}, {}", *indices[::-1], at=node, last=indices[1], exact=True)


def _brackets(s: Solution, node: Any) -> Iterator[Change]:
    if isinstance(node, ast.BinOp) and isinstance(s.parents[node], ast.BinOp | ast.UnaryOp):
        start, end = s.span(node)
        if s.bytes[start - 1 : start] + s.bytes[end : end + 1] == b"()":
            what = f"the brackets around {s.quote(node)} are missing{s.place(s.parents[node])}"
            yield Change("missing-brackets", what, (start - 1, end + 1), "{}", (node,), exact=True)


def _factors(s: Solution, node: Any) -> Iterator[Change]:
    if is_operation(node, *PRODUCT):
        whole, divided, left, right = s.product(node), is_operation(node, ast.Div), node.left, node.right
        number, where = isinstance(right, ast.Constant), f"in {s.quote(whole)} is missing"
        code = "constant-factor" if number else "missing-division" if divided else "missing-term"
        yield s.change(code, f"the {'division by' if divided else 'factor'} {s.quote(right)} {where}", node, "{}", left, at=whole)
        if not is_operation(left, *PRODUCT):
            minus = isinstance(left, ast.UnaryOp)
            factor, new = left.operand if minus else left, ("-" if minus else "") + ("1 / {}" if divided else "{}")
            code = "constant-factor" if isinstance(factor, ast.Constant) else "missing-term"
            yield s.change(code, f"the factor {s.quote(factor)} {where}", node, new, right, at=whole)
        if divided:
            what = f"numerator and denominator of {s.quote(node)} are exchanged"
            yield s.change("wrong-divisor", what, node, "{} / {}", right, left)
    elif is_operation(node, ast.Pow):
        what = f"the exponent {s.quote(node.right)} of {s.quote(node)} is missing"
        yield s.change("wrong-power", what, node, "{}", node.left)


def _multiples(s: Solution, node: Any) -> Iterator[Change]:
    if s.is_term(node) and s.outer(node, ast.Subscript, ast.Compare, ast.stmt) is s.outer(node, ast.stmt):
        yield s.change("constant-factor", f"{s.quote(node)} is halved", node, "{} / 2", node)
        if is_operation(node, *PRODUCT) or s.is_returned(node):
            yield s.change("constant-factor", f"{s.quote(node)} is doubled", node, "2 * {}", node)


def _calls(s: Solution, node: Any) -> Iterator[Change]:
    name = called(node)
    args: list[Any] = getattr(node, "args", [])
    if not name or any(isinstance(a, ast.Starred) for a in args):
        return
    method = isinstance(node.func, ast.Attribute)
    if other := IN_PLACE_OF.get(name):
        what, new = f"`{other}` stands in place of `{name}` in {s.quote(node)}", f"{{}}.{other}" if method else other
        yield s.change("wrong-function", what, node.func, new, *([node.func.value] if method else []), at=node)
    if name in DROPPED.split(",") and (args or method):
        yield s.change(
            "wrong-function", f"`{name}` is missing in {s.quote(node)}", node, "{}", args[0] if args else node.func.value
        )
    for bound in args[:2] if name == "range" else ():
        for new, word in (("{} - 1", "less"), ("{} + 1", "more")):
            yield s.change("off-by-one", f"the bound {s.quote(bound)} of {s.quote(node)} is one {word}", bound, new, bound, at=node)
    if len(args) > 1 and name not in COMMUTATIVE.split(",") and ast.dump(args[0]) != ast.dump(args[1]):
        what = f"the arguments {s.quote(args[0])} and {s.quote(args[1])} of `{name}` are exchanged"
        yield s.change("swapped-arguments", what, args[0], "{}, {}", args[1], args[0], at=node, last=args[1], exact=True)
    for before, given in pairwise([*args[-2 if method else -1 :], *getattr(node, "keywords", ())]):
        value, key = (given.value, given.arg) if isinstance(given, ast.keyword) else (None, "")
        if isinstance(value, ast.Constant) and isinstance(value.value, bool):
            yield s.stands("wrong-option", value, str(not value.value), given)
        elif key is not None and key != "dtype":
            if key == "axis" and (axis := integer(value)) is not None:
                yield s.stands("wrong-index", value, "0" if axis else "1", given)
            what = f"the argument {s.quote(given)} of `{name}` is missing"
            yield s.change("missing-argument", what, before, "{}", before, at=node, last=given, exact=True)


def _operators(s: Solution, node: Any) -> Iterator[Change]:
    kind = type(getattr(node, "op", None))
    against_zero = any(integer(side) == 0 for side in getattr(s.parents.get(node), "comparators", ()))
    if isinstance(node, ast.BinOp) and kind in OPERATORS and not against_zero:
        old, new = OPERATORS[kind].split()
        what = f"`{new}` stands in place of `{old}` before {s.quote(node.right)} in {s.quote(node)}"
        yield s.change("wrong-operator", what, node, f"{{}} {new} {{}}", node.left, node.right)
    elif isinstance(node, ast.AugAssign) and kind in ASSIGNED:
        old, new = ASSIGNED[kind].split()
        what = f"`{new}` stands in place of `{old}` in {s.quote(node)}"
        yield s.change("wrong-operator", what, node, f"{{}} {new} {{}}", node.target, node.value, exact=True)
    elif isinstance(node, ast.BoolOp) and len(node.values) == 2:
        old, new = ("and", "or") if kind is ast.And else ("or", "and")
        what = f"`{new}` stands in place of `{old}` in {s.quote(node)}"
        yield s.change("wrong-operator", what, node, f"{{}} {new} {{}}", *node.values)
    elif kind is ast.Not:
        yield s.change("wrong-comparison", f"the condition {s.quote(node)} is reversed", node, "{}", node.operand)
    elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in COMPARED:
        old, reverse, *equality = COMPARED[type(node.ops[0])].split()
        sides = (node.left, node.comparators[0])
        yield s.change("wrong-comparison", f"the comparison {s.quote(node)} is reversed", node, f"{{}} {reverse} {{}}", *sides)
        if equality and not any(isinstance(n, ast.Call) or is_operation(n, *PRODUCT, ast.Pow) for n in ast.walk(node)):
            what = f"`{equality[0]}` stands in place of `{old}` in {s.quote(node)}"
            yield s.change("wrong-comparison", what, node, f"{{}} {equality[0]} {{}}", *sides)


def _orders(s: Solution, node: Any) -> Iterator[Change]:
    if isinstance(node, ast.List | ast.Tuple) and node.elts and s.is_returned(node.elts[0]):
        for first, second in pairwise(node.elts[:4]):
            what = f"{s.quote(first)} and {s.quote(second)} are returned in the other order"
            yield Change("component-order", what, s.span(first, second), "{}, {}", (second, first), exact=True)
    elif isinstance(node, ast.Attribute) and node.attr == "T":
        yield s.change("transposed", f"`.T` is missing after {s.quote(node.value)}", node, "{}", node.value)
    elif (
        isinstance(node, ast.Name) and node.id[0].isupper() and (is_operation(s.parents[node], ast.MatMult) or s.is_returned(node))
    ):
        yield s.stands("transposed", node, f"{node.id}.T")


def _constants(s: Solution, node: Any) -> Iterator[Change]:
    parent, value = s.parents.get(node), getattr(node, "value", None)
    if not isinstance(node, ast.Constant) or not isinstance(value, int | float) or isinstance(value, bool):
        return
    if isinstance(parent, ast.Subscript | ast.Slice | ast.keyword) or called(parent) == "range":
        return
    code = "constant-factor" if is_operation(parent, *PRODUCT) else "wrong-constant"
    code = "wrong-power" if is_operation(parent, ast.Pow) else code
    for other in (value + 1, value - 1) if isinstance(value, int) else (value * 2, value / 2):
        if other > 0:
            yield s.stands(code, node, repr(other), parent if isinstance(parent, ast.BinOp) else node)


def _names(s: Solution, node: Any) -> Iterator[Change]:
    attribute = isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "self"
    if not (attribute or isinstance(node, ast.Name)) or not isinstance(node.ctx, ast.Load):
        return
    around = s.outer(node, ast.stmt, ast.Compare)
    if (
        called(s.parents[node]).endswith(("_like", "len"))
        or isinstance(around, ast.Compare)
        or (isinstance(around, ast.Assign) and "self." in s.text(around.targets[0]))
    ):
        return
    outer, own = s.outer(node, ast.ClassDef if attribute else ast.FunctionDef), node.attr if attribute else node.id
    known = s.variables(outer, attribute)
    _, use = known.get(own, (0, {"called"}))
    alike = [n for n, (first, uses) in known.items() if n == own or (uses in (set(), use) and (attribute or first < node.lineno))]
    k = alike.index(own) if own in alike else 0
    for other in [] if "called" in use else alike[max(k - 1, 0) : k] + alike[k + 1 : k + 2]:
        whole = s.parents[node] if isinstance(s.parents[node], ast.Attribute) else node
        yield s.stands("wrong-variable", node, f"self.{other}" if attribute else other, whole)


RULES = (_terms, _indices, _brackets, _factors, _multiples, _calls, _operators, _orders, _constants, _names)  # common first
