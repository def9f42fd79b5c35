"""Wrong versions of a right solution: each changes one place of its source and says so in a sentence."""

import ast
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from itertools import pairwise
from typing import Any

from exercises.authoring.mutants.equivalence import fingerprint
from exercises.authoring.mutants.solution import PRODUCT, SUM, Solution, Variant, called, is_operation

ALIKE = (
    ("sin", "cos"),
    ("sinh", "cosh"),
    ("arcsin", "arccos"),
    ("asin", "acos"),
    ("min", "max"),
    ("minimum", "maximum"),
    ("argmin", "argmax"),
    ("floor", "ceil"),
    ("sum", "mean"),
    ("var", "std"),
    ("fft", "ifft"),
    ("real", "imag"),
    ("log", "log10"),
    ("zeros", "ones"),
    ("dot", "cross"),
    ("cumsum", "cumprod"),
    ("deg2rad", "rad2deg"),
)
"""Functions that are taken for each other."""
IN_PLACE_OF = {**dict(ALIKE), **{right: left for left, right in ALIKE}}
DROPPED = {
    "sqrt",
    "exp",
    "log",
    "abs",
    "absolute",
    "conj",
    "conjugate",
    "real",
    "floor",
    "int",
    "round",
    "inv",
    "sort",
    "cumsum",
    "radians",
    "deg2rad",
    "fftshift",
    "unwrap",
}
"""Functions whose call is forgotten."""
COMMUTATIVE = {
    "min",
    "max",
    "minimum",
    "maximum",
    "hypot",
    "allclose",
    "isclose",
    "isinstance",
    "zip",
    "range",
}
"""Functions of which it does not matter in which order they get their arguments, or whose mistake is rare."""
FREQUENT = (
    "sign-flipped",
    "missing-term",
    "constant-factor",
    "wrong-power",
    "missing-division",
    "wrong-function",
)
MOST_FIRST, MOST_PAIRS = 16, 300


Rule = Callable[[Solution, Any], Iterator[Variant]]


def variants(source: str) -> list[Variant]:
    """Return the wrong versions of a solution in the order of its lines.

    No version equals the source or another version up to rules of arithmetic; of equal ones the most common
    mistake stays.

    Raises SyntaxError if the source is not valid Python.
    """
    solution, found = Solution(source), {fingerprint(source): Variant("", "", source)}
    for variant in (variant for rule in RULES for node in solution.nodes for variant in rule(solution, node)):
        with suppress(SyntaxError):
            found.setdefault(fingerprint(variant.source), variant)
    return sorted(list(found.values())[1:], key=lambda variant: variant.line)


def pairs(source: str) -> list[Variant]:
    """Return the versions of a solution with two of the most frequent changes, the earlier one first.

    Raises SyntaxError if the source is not valid Python.
    """
    single = variants(source)
    known = {fingerprint(source), *(fingerprint(one.source) for one in single)}
    found: dict[Any, Variant] = {}
    for first in [one for one in single if one.code in FREQUENT][:MOST_FIRST]:
        for second in [
            one for one in variants(first.source) if one.code in FREQUENT and one.line >= first.line
        ]:
            if (mark := fingerprint(second.source)) not in known:
                found.setdefault(
                    mark, Variant(first.code, first.sentence, second.source, both=(first, second))
                )
    return list(found.values())[:MOST_PAIRS]


CLASSES: Mapping[str, Callable[[Solution, Any], bool]] = {
    "F": lambda s, node: not is_operation(node, *PRODUCT) and not isinstance(node, ast.UnaryOp),
    "H": lambda s, node: (
        s.is_term(node) and s.outer(node, ast.Subscript, ast.Compare, ast.stmt) is s.outer(node, ast.stmt)
    ),
    "D": lambda s, node: CLASSES["H"](s, node) and (is_operation(node, *PRODUCT) or s.is_returned(node)),
    "M": lambda s, node: (
        isinstance(node, ast.Name)
        and node.id[0].isupper()
        and (is_operation(s.parents[node], ast.MatMult) or s.is_returned(node))
    ),
    **dict.fromkeys(
        "PQ",
        lambda s, node: (
            not any(isinstance(n, ast.Call) or is_operation(n, *PRODUCT, ast.Pow) for n in ast.walk(node))
        ),
    ),
    "S": lambda s, node: not is_operation(node, *SUM),
    "T": lambda s, node: s.is_term(node) and not s.text(node).startswith("-"),
    "V": lambda s, node: not isinstance(node, ast.Constant),
}
"""What a name of one letter in a pattern stands for; the other letters stand for any expression."""


def table(*rows: tuple[str, str, str, str]) -> Rule:
    """Return the rule with these rows: code, pattern, what stands in its place, and the sentence, whose last
    part is the place.

    The parts are the letters of the pattern, ``node``, and ``whole``, the largest product around it, in their
    ``Solution.forms``. A missing factor that is a number has the code constant-factor.
    """
    patterns = [(code, ast.parse(pattern).body[0], new, sentence) for code, pattern, new, sentence in rows]

    def rule(s: Solution, node: Any) -> Iterator[Variant]:
        for code, pattern, new, sentence in patterns:
            nodes: dict[str, Any] = {}
            if _matches(s, pattern.value if isinstance(pattern, ast.Expr) else pattern, node, nodes):
                nodes |= {"node": node, "whole": s.product(node)}
                forms = {
                    form: text for name, part in nodes.items() for form, text in s.forms(name, part).items()
                }
                first, *_, at = re.findall(r"{(\w+?)_", sentence) * 2
                factor = at == "whole" and isinstance(nodes[first], ast.Constant)
                named = "constant-factor" if factor else code
                yield s.change(named, sentence.format(**forms), node, new.format(**forms), at=nodes[at])

    return rule


def _matches(s: Solution, pattern: Any, node: Any, nodes: dict[str, Any]) -> bool:
    """Return whether a node has the form of a pattern, and add what the pattern's letters stand for to
    ``nodes``.
    """
    match pattern:
        case ast.Name(id=letter):
            nodes[letter] = node
            return isinstance(node, ast.expr | ast.Slice) and (
                letter not in CLASSES or CLASSES[letter](s, node)
            )
        case ast.AST():
            fields = ast.iter_fields(pattern)
            return type(pattern) is type(node) and all(
                _matches(s, part, getattr(node, name), nodes) for name, part in fields
            )
        case list():
            return len(pattern) == len(node) and all(
                _matches(s, *pair, nodes) for pair in zip(pattern, node, strict=True)
            )
    return bool(pattern == node)


OPPOSITE, MISSING = "{B_t} has the opposite sign", "the factor {%s_q} in {whole_q} is missing"
INSTEAD = "`%s` stands in place of `%s` in {node_q}"

_terms = table(
    ("sign-flipped", "A + B", "{A} - {B}", OPPOSITE),
    ("sign-flipped", "A - B", "{A} + {B}", OPPOSITE),
    ("sign-flipped", "A - B", "{B} - {A}", "{node_q} has the opposite sign"),
    ("missing-term", "A + B", "{A}", "{B_t} is missing"),
    ("missing-term", "A - B", "{A}", "{B_t} is missing"),
    ("missing-term", "S + B", "{B}", "{S_t} is missing"),
    ("missing-term", "S - B", "-{B}", "{S_t} is missing"),
    ("sign-flipped", "-V", "{V}", "{whole_t} has the opposite sign"),
    ("sign-flipped", "A += B", "{A} -= {B}", OPPOSITE),
    ("sign-flipped", "A -= B", "{A} += {B}", OPPOSITE),
    ("sign-flipped", "T", "-{T}", "{T_t} has the opposite sign"),
)
_exchanged_indices = table(
    ("wrong-index", "A[B, C]", "{A}[{C_r}, {B_r}]", "the indices of {node_q} are exchanged")
)
_factors = table(
    ("missing-term", "A * B", "{A}", MISSING % "B"),
    ("missing-division", "A / B", "{A}", "the division by {B_q} in {whole_q} is missing"),
    ("missing-term", "F * B", "{B}", MISSING % "F"),
    ("missing-term", "-A * B", "-{B}", MISSING % "A"),
    ("missing-term", "F / B", "1 / {B}", MISSING % "F"),
    ("missing-term", "-A / B", "-1 / {B}", MISSING % "A"),
    ("wrong-divisor", "A / B", "{B} / {A}", "numerator and denominator of {node_q} are exchanged"),
    ("wrong-power", "A ** B", "{A}", "the exponent {B_q} of {node_q} is missing"),
)
_multiples = table(
    ("constant-factor", "H", "{H} / 2", "{H_q} is halved"),
    ("constant-factor", "D", "2 * {D}", "{D_q} is doubled"),
)
_operators = table(
    *[
        (
            "wrong-operator",
            f"A {old} B",
            f"{{A}} {new} {{B}}",
            f"`{new}` stands in place of `{old}` before {{B_q}} in {{node_q}}",
        )
        for old, new in ("*/", "/*", ("//", "/"), ("%", "//"), ("**", "*"), "@*")
    ],
    *[
        ("wrong-operator", f"A {old} B", f"{{A}} {new} {{B}}", INSTEAD % (new, old))
        for old, new in (("+=", "="), ("-=", "="), ("*=", "/="), ("/=", "*="), ("and", "or"), ("or", "and"))
    ],
    ("wrong-comparison", "not A", "{A}", "the condition {node_q} is reversed"),
    *[
        ("wrong-comparison", f"A {old} B", f"{{A}} {new} {{B}}", "the comparison {node_q} is reversed")
        for old, new in ("<>", "><", ("<=", ">="), (">=", "<="), ("==", "!="), ("!=", "=="))
    ],
    *[
        ("wrong-comparison", f"P {old} Q", f"{{P}} {new} {{Q}}", INSTEAD % (new, old))
        for old, new in (("<", "<="), ("<=", "<"), (">", ">="), (">=", ">"))
    ],
)
_transposed = table(
    ("transposed", "A.T", "{A}", "`.T` is missing after {A_q}{node_r:.0}"),  # the place is the node, not A
    ("transposed", "M", "{M}.T", "`{M_r}.T` stands in place of {M_q}"),
)


def _indices(s: Solution, node: Any) -> Iterator[Variant]:
    if isinstance(node, ast.Subscript):
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        bounds = [
            b
            for i in indices
            if isinstance(i, ast.Slice)
            for b in (i.lower, i.upper, i.step)
            if b is not None
        ]
        for part in (*indices, *bounds):
            near = (
                []
                if (value := _integer(part)) is None
                else [k for k in (value + 1, value - 1) if (k < 0) == (value < 0)]
            )
            others = ["", *map(str, filter(None, near))] if part in bounds else list(map(str, near))
            if isinstance(part, ast.Name) and part in indices:
                others = [f"{part.id} - 1", f"{part.id} + 1"]
            yield from (s.stands("wrong-index", part, other, node) for other in others)


def _brackets(s: Solution, node: Any) -> Iterator[Variant]:
    if isinstance(node, ast.BinOp) and isinstance(s.parents[node], ast.BinOp | ast.UnaryOp):
        start, end = s.span(node)
        if s.bytes[start - 1 : start] + s.bytes[end : end + 1] == b"()":
            what = f"the brackets around {s.quote(node)} are missing{s.place(s.parents[node])}"
            yield s.replaced("missing-brackets", what, (start - 1, end + 1), s.text(node))


def _calls(s: Solution, node: Any) -> Iterator[Variant]:
    name, args = called(node), getattr(node, "args", [])
    if not name or any(isinstance(a, ast.Starred) for a in args):
        return
    of = s.text(node.func.value) if isinstance(node.func, ast.Attribute) else ""
    if other := IN_PLACE_OF.get(name):
        what = f"`{other}` stands in place of `{name}` in {s.quote(node)}"
        yield s.change("wrong-function", what, node.func, f"{of}.{other}" if of else other, at=node)
    if name in DROPPED and (args or of):
        yield s.change(
            "wrong-function", f"`{name}` is missing in {s.quote(node)}", node, s.text(args[0]) if args else of
        )
    for bound in args[:2] if name == "range" else ():
        for sign, word in (("-", "less"), ("+", "more")):
            what = f"the bound {s.quote(bound)} of {s.quote(node)} is one {word}"
            yield s.change("off-by-one", what, bound, f"{s.text(bound)} {sign} 1", at=node)
    if len(args) > 1 and name not in COMMUTATIVE:
        what = f"the arguments {s.quote(args[0])} and {s.quote(args[1])} of `{name}` are exchanged"
        yield s.change(
            "swapped-arguments", what, args[0], f"{s.text(args[1])}, {s.text(args[0])}", at=node, last=args[1]
        )
    for before, given in pairwise([*args[-2 if of else -1 :], *node.keywords]):
        key, value = getattr(given, "arg", ""), getattr(given, "value", given)
        if key and isinstance(getattr(value, "value", None), bool):
            yield s.stands("wrong-option", value, str(not value.value), given)
        elif key is not None and key != "dtype":
            if key == "axis" and (axis := _integer(value)) is not None:
                yield s.stands("wrong-index", value, "0" if axis else "1", given)
            what = f"the argument {s.quote(given)} of `{name}` is missing"
            yield s.change("missing-argument", what, before, s.text(before), at=node, last=given)


def _orders(s: Solution, node: Any) -> Iterator[Variant]:
    if isinstance(node, ast.List | ast.Tuple) and node.elts and s.is_returned(node.elts[0]):
        for first, second in pairwise(node.elts[:4]):
            what = f"{s.quote(first)} and {s.quote(second)} are returned in the other order"
            yield s.replaced(
                "component-order", what, s.span(first, second), f"{s.text(second)}, {s.text(first)}"
            )


def _constants(s: Solution, node: Any) -> Iterator[Variant]:
    parent, value = s.parents.get(node), getattr(node, "value", None)
    if not isinstance(node, ast.Constant) or not isinstance(value, int | float) or isinstance(value, bool):
        return
    if isinstance(parent, ast.Subscript | ast.Slice | ast.keyword) or called(parent) == "range":
        return
    factor, power = is_operation(parent, *PRODUCT), is_operation(parent, ast.Pow)
    code = "constant-factor" if factor else "wrong-power" if power else "wrong-constant"
    for other in (value + 1, value - 1) if isinstance(value, int) else (value * 2, value / 2):
        if other > 0:
            yield s.stands(code, node, repr(other), parent if isinstance(parent, ast.BinOp) else node)


def _names(s: Solution, node: Any) -> Iterator[Variant]:
    attribute = (
        isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "self"
    )
    if not (attribute or isinstance(node, ast.Name)) or not isinstance(node.ctx, ast.Load):
        return
    around = s.outer(node, ast.stmt, ast.Compare)
    stored = isinstance(around, ast.Assign) and "self." in s.text(around.targets[0])
    if stored or isinstance(around, ast.Compare) or called(s.parents[node]).endswith(("_like", "len")):
        return
    own = node.attr if attribute else node.id
    known = s.variables(
        s.outer(node, ast.ClassDef if attribute else ast.FunctionDef),
        ast.Attribute if attribute else ast.Name,
    )
    _, use = known.get(own, (0, {"called"}))
    alike = [
        n
        for n, (first, uses) in known.items()
        if n == own or (uses in (set(), use) and (attribute or first < node.lineno))
    ]
    k = alike.index(own) if own in alike else 0
    whole = s.parents[node] if isinstance(s.parents[node], ast.Attribute) else node
    for other in [] if "called" in use else alike[max(k - 1, 0) : k] + alike[k + 1 : k + 2]:
        yield s.stands("wrong-variable", node, f"self.{other}" if attribute else other, whole)


def _constant_arguments(s: Solution, node: Any) -> Iterator[Variant]:
    """Yield the function with a constant in place of one of its arguments."""
    if isinstance(node, ast.FunctionDef) and node in s.tree.body:
        body = [part for part in node.body if not isinstance(part, ast.Expr)]
        read = {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Load)}
        for argument in [a.arg for a in node.args.args if a.arg in read and body]:
            start, _ = s.span(body[0])
            behind = "; " if body[0].lineno == node.lineno else "\n" + " " * body[0].col_offset
            for value in ("1", "0"):
                what = f"the argument `{argument}` has no effect, as if it were always {value}"
                yield s.replaced("wrong-constant", what, (start, start), f"{argument} = {value}{behind}")


def _replaced_inputs(s: Solution, node: Any) -> Iterator[Variant]:
    """Yield a return of new values of two arguments where one is computed from the new value of the other."""
    if not isinstance(node, ast.Return) or not isinstance(node.value, ast.Tuple) or len(node.value.elts) != 2:
        return
    function = s.outer(node, ast.FunctionDef)
    arguments = [a.arg for a in function.args.args] if isinstance(function, ast.FunctionDef) else []
    own = [_first_term(part) for part in node.value.elts]
    if own[0] == own[1] or not set(own) <= set(arguments) or node.lineno == function.lineno:
        return
    for first, second in ((0, 1), (1, 0)):
        uses = {n.id for n in ast.walk(node.value.elts[second]) if isinstance(n, ast.Name)}
        if own[first] in uses:
            lines = [f"{own[k]} = {s.text(node.value.elts[k])}" for k in (first, second)]
            text = ("\n" + " " * node.col_offset).join([*lines, f"return {own[0]}, {own[1]}"])
            what = f"`{own[second]}` is computed with the new `{own[first]}` in place of the old one"
            yield s.replaced("wrong-variable", what, s.span(node), text)


def _first_term(node: Any) -> str:
    """Return the variable that a sum begins with, "" if it does not begin with one."""
    while is_operation(node, *SUM):
        node = node.left
    return node.id if isinstance(node, ast.Name) else ""


def _integer(node: Any) -> int | None:
    """Return the value of an integer literal, also a negative one, None if ``node`` is no such literal."""
    with suppress(ValueError, TypeError):
        value = ast.literal_eval(node)
        return value if type(value) is int else None
    return None


RULES: tuple[Rule, ...] = (
    *(_terms, _indices, _exchanged_indices, _brackets, _factors, _multiples, _calls, _operators, _orders),
    *(_transposed, _constants, _names, _replaced_inputs, _constant_arguments),
)
"""The rules, common mistakes first."""
