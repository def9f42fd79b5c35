"""The line of the student's source that a failure is about: where it raised, or computes a component.

The source is never parsed here: it may be hostile, and a parser can be crashed. Its tokens are enough.
"""

import io
import re
import tokenize
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from keyword import iskeyword

FRAME = re.compile(r'^\s*File "([^"]+)", line (\d+)')
BREAK = re.compile(r"\r\n|\r|\n")  # Python's line breaks; a form feed, for example, is none
CARETS = re.compile(r"^\s*[~^]*\^[~^]*\s*$")
MOST = 300  # characters that are quoted of a line
MOST_NAMES = 4  # names followed from a returned name to what it stands for
MOST_NESTED = 40  # brackets within brackets
LAYOUT = (tokenize.INDENT, tokenize.DEDENT, tokenize.NL, tokenize.COMMENT, tokenize.ENCODING)

Token = tokenize.TokenInfo


@dataclass(frozen=True)
class StudentLine:
    """A line of the student's source, in the cell or file that tracebacks name, or "".

    The characters from ``start`` up to ``end`` are what it is about; all of it if both are 0. ``about`` is
    the sentence of the diagnosis that it belongs to.
    """

    cell: str
    number: int
    text: str = ""
    start: int = 0
    end: int = 0
    about: str = ""

    @property
    def place(self) -> str:
        """Return "cell 3, line 2", or "line 2" without a cell."""
        return f"{self.cell}, line {self.number}" if self.cell else f"line {self.number}"

    def parts(self) -> tuple[str, str, str]:
        """Return the text before, in and after what the line is about."""
        start, end = (self.start, self.end) if self.end > self.start else (0, len(self.text))
        return self.text[:start], self.text[start:end], self.text[end:]

    def __str__(self) -> str:
        return f"{self.place}: {self.text}" if self.text else self.place


def raised(traceback: str | None) -> StudentLine | None:
    """Return the last line of a traceback that is the student's, None if there is none."""
    found, lines = None, (traceback or "").split("\n")
    for at, (head, source) in enumerate(pairwise([*lines, ""])):
        if head and not head[0].isspace():
            break  # the exception's own text
        if frame := FRAME.match(head):
            cell = "" if "/" in frame[1] or "<" in frame[1] else frame[1]
            shown = "" if FRAME.match(source) or not source[:1].isspace() else source
            below = lines[at + 2] if shown and at + 2 < len(lines) else ""
            found = _quoted(StudentLine(cell, int(frame[2][:9]), shown, *_marked(below)))
    return found


def _marked(below: str) -> tuple[int, int]:
    """Return the columns that the carets in the line below a source line mark."""
    if not CARETS.match(below):
        return 0, 0
    return len(below) - len(below.lstrip()), len(below.rstrip())


def _quoted(line: StudentLine) -> StudentLine:
    """Return a line of source as it is shown: without its indentation, cut and printable."""
    indent = len(line.text) - len(line.text.lstrip())
    text = "".join(c if c.isprintable() else "\ufffd" for c in line.text.strip())[:MOST]
    start, end = (min(max(0, column - indent), len(text)) for column in (line.start, line.end))
    return replace(line, text=text, start=start, end=end)


def of_component(
    cells: Iterable[tuple[str, str]], function: str, k: int, about: str = ""
) -> StudentLine | None:
    """Return the line on which a function computes component ``k``, from 0, of what it returns, None if that
    is not evident.

    ``cells`` are names and sources in the order in which they run: the last definition counts.
    """
    name = re.escape(function)
    defined = re.compile(rf"^[ \t]*(?:async[ \t]+)?def[ \t]+{name}\b|^{name}[ \t]*=(?!=)", re.MULTILINE)
    for cell, written in reversed(list(cells)):
        source = BREAK.sub("\n", written)
        if found := list(defined.finditer(source)):
            begin = found[-1].start()
            statements = _statements(source[begin:])
            tokens = _component(statements, k)
            if not tokens:
                return None
            first, last = tokens[0], tokens[-1]
            row = first.start[0]
            end = last.end[1] if last.end[0] == row else len(first.line.rstrip("\n"))
            line = source[begin:].split("\n")[row - 1]
            number = source.count("\n", 0, begin) + row
            return _quoted(StudentLine(cell, number, line, first.start[1], end, about))
    return None


def tokens_of(sources: Iterable[str], function: str) -> list[str]:
    """Return the texts of the tokens of the last definition of a function or class, none if there is none."""
    defined = re.compile(rf"^[ \t]*(?:async[ \t]+)?(?:def|class)[ \t]+{re.escape(function)}\b", re.MULTILINE)
    for written in reversed(list(sources)):
        source = BREAK.sub("\n", written)
        if found := list(defined.finditer(source)):
            statements = _statements(source[found[-1].start() :])
            return [token.string for statement in statements for token in statement]
    return []


def _statements(source: str) -> list[list[Token]]:
    """Return the statements of the definition with which ``source`` begins, each as its tokens."""
    found: list[list[Token]] = [[]]
    depth = 0
    try:
        for token in tokenize.generate_tokens(io.StringIO(source).readline):
            depth += (token.type == tokenize.INDENT) - (token.type == tokenize.DEDENT)
            ended = token.type == tokenize.NEWLINE or token.string == ";"
            if ended and found[-1]:
                found.append([])
            elif token.type not in LAYOUT and not ended:
                if depth <= 0 and len(found) > 1:
                    break  # the code after the definition
                found[-1].append(token)
    except (tokenize.TokenError, SyntaxError):
        pass  # an unfinished cell: what was read so far
    return [statement for statement in found if statement]


def _component(statements: Sequence[list[Token]], k: int) -> list[Token]:
    """Return the tokens of component ``k`` of what the statements return, none if they do not say it."""
    returned = _after(statements, "return") or _after(statements, "lambda", then=":")
    for _ in range(MOST_NAMES):
        if len(returned) != 1 or returned[0].type != tokenize.NAME:
            break
        name = returned[0].string
        if own := [s for s in statements if _assigns_element(s, name, k)]:
            return own[-1]
        returned = next((s[2:] for s in reversed(statements) if _assigns(s, name)), [])
    element = next((each[k] for each in _displays(returned) if k < len(each)), [])
    for _ in range(MOST_NAMES):
        if len(element) != 1 or element[0].type != tokenize.NAME:
            break
        assigned = next((s for s in reversed(statements) if _assigns(s, element[0].string)), element)
        if len(assigned) != len("x=y"):
            return assigned
        element = assigned[2:]
    return element


def _after(statements: Sequence[list[Token]], word: str, then: str = "") -> list[Token]:
    """Return what follows ``word``, or ``then`` after it, in the last statement that has it."""
    for statement in reversed(statements):
        words = [token.string for token in statement]
        if word in words:
            at = words.index(word)
            at = words.index(then, at) if then in words[at:] else at
            return statement[at + 1 :]
    return []


def _assigns(statement: list[Token], name: str) -> bool:
    return len(statement) > 2 and [token.string for token in statement[:2]] == [name, "="]


def _assigns_element(statement: list[Token], name: str, k: int) -> bool:
    """Return whether a statement is ``name[k] = …``."""
    return [token.string for token in statement[:5]] == [name, "[", str(k), "]", "="]


@dataclass
class _Brackets:
    """Brackets, or what stands outside of all: their elements, and whether they are a tuple or list."""

    display: bool
    elements: list[list[Token]] = field(default_factory=lambda: [[]])


def _displays(tokens: Sequence[Token]) -> list[list[list[Token]]]:
    """Return the elements of each tuple or list that is written out with at least two, outer ones first."""
    opened, before = [_Brackets(display=True)], ""
    found = opened[:]
    for token in tokens:
        if token.string in (")", "]", "}") and len(opened) > 1:
            opened.pop()
        comma = token.string == ","
        for brackets in opened[:-1] if comma else opened:
            brackets.elements[-1].append(token)
        if comma:
            opened[-1].elements.append([])
        elif token.string in ("(", "[", "{"):
            if len(opened) > MOST_NESTED:
                return []
            called = before in (")", "]") or (before.isidentifier() and not iskeyword(before))
            opened.append(_Brackets(display=token.string != "{" and not called))
            found.append(opened[-1])
        before = token.string
    shown = [[element for element in one.elements if element] for one in found if one.display]
    return [elements for elements in shown if len(elements) > 1]
