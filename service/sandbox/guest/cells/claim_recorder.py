"""The calls of a course's validation words in a notebook's cells, sent to the host as data while the cells
run.

The words are those of the course's own package, wrapped in its modules: each call runs unchanged, prints its
own line, and raises its own AssertionError.
"""

import ast
import functools
import importlib
import inspect
import math
import re
import sys
import traceback
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType, ModuleType
from typing import Any

import numpy as np

from polhode.judging.author_errors import AuthorError
from polhode.judging.claims import KINDS, MOST_DETAIL, MOST_LABEL, kind_of, one_line, words_in

from ..time_budget import Budget, OutOfTime, limited
from ..wire import Writer
from .jupytext_cells import nodes_of

MOST_CLAIMS = 100  # of the cells of one submission
MOST_AT_PLACE = 1000  # of one call in a published cell
MOST_REPORTED = 10_000  # of all published cells
MOST_CUT = 1000  # calls of published cells of which not every claim is sent
MOST_NUMBERS = 1 << 16  # of one frame: 512 KiB
MOST_IN_FIELD = 10**7  # of one claim, sent in blocks
MOST_IN_ALL = 10**8  # numbers of all claims
MOST_AXES = 8
IMPORT_S = 10.0  # of CPU time, for one module of the course with all that it imports
MARKS = "✓✗"
BRACKETS = re.compile(r" *\[(.*?)\](?:\n|$)", re.DOTALL)
course = list[str]()  # folders with the course's own packages
_getframe = sys._getframe  # a submission can replace it


class Recorder:
    """Recorder of the claims in each ``cell``, which it sends. Of one that is too large it sends the reason
    in place of the arrays.
    """

    def __init__(self, write: Writer) -> None:
        self._write = write
        self.cell, self._claims = "", 0
        self._numbers = {False: 0, True: 0}  # of the submission's own cells and of the published ones
        self._reported, self._all_reported = Counter[tuple[str, int, int]](), 0
        self._cut = set[tuple[str, int, int]]()
        self.places = False  # whether claims are sent with their place in the cell's source
        self.words = list[Callable[..., Any]]()  # as the modules have them now
        self._records, self._inside = False, False
        self._raised: BaseException | None = None

    def wrap(self, sources: Iterable[str]) -> None:
        """Import the course's modules that ``sources`` import, and wrap the words in them, before a
        submission can replace them. Raises AuthorError if one cannot be imported.
        """
        tops, wanted = _mentioned(sources)
        words: dict[str, set[str]] = {}
        for folder in course if tops else ():
            for known, listed in words_in(Path(folder)).items():
                if known.partition(".")[0] in tops:
                    words.setdefault(known, set()).update(listed)
        for name in sorted(wanted | words.keys()):
            _import(name)
        for name, names in words.items():
            module = sys.modules.get(name)
            for word in names if module is not None else ():
                function = vars(module).get(word)
                if inspect.isfunction(function) and function not in self.words:
                    self._put(function, self._wrapped(word, function))

    def _put(self, function: Callable[..., Any], wrapped: Callable[..., Any]) -> None:
        """Put a wrapped word wherever a module of its package has it."""
        top = function.__module__.partition(".")[0]
        for name, module in list(sys.modules.items()):
            if name.partition(".")[0] == top and isinstance(module, ModuleType):
                for key in [key for key, value in vars(module).items() if value is function]:
                    setattr(module, key, wrapped)
        self.words.append(wrapped)

    def _wrapped(self, kind: str, function: Callable[..., Any]) -> Callable[..., Any]:
        signature = inspect.signature(function)

        @functools.wraps(function)
        def word(*args: Any, **kwargs: Any) -> Any:
            if self._inside or not self._records:
                return function(*args, **kwargs)
            said = _Said(sys.stdout)
            self._inside, sys.stdout = True, said
            try:
                returned, raised = function(*args, **kwargs), None
            except AssertionError as error:
                returned, raised = False, error
            finally:
                self._inside = False
                if sys.stdout is said:
                    sys.stdout = said.stdout
            with suppress(TypeError):
                given = signature.bind(*args, **kwargs)
                given.apply_defaults()
                self._record(kind, given.arguments, said.text, returned, raised)
            if raised is not None:
                self._raised = raised
                raise raised
            return returned

        return word

    def has_raised(self, error: BaseException | None) -> bool:
        """Return whether a word has raised this ``error``: the claim that it made says so already."""
        return error is not None and error is self._raised

    @contextmanager
    def recording(self) -> Iterator[None]:
        """Record the claims made inside the ``with`` block."""
        self._records = True
        try:
            yield
        finally:
            self._records = False

    @property
    def left_out(self) -> int:
        """The number of claims beyond the limit."""
        return max(0, self._claims - MOST_CLAIMS)

    def _record(
        self, kind: str, given: Mapping[str, Any], printed: str, returned: Any, raised: BaseException | None
    ) -> None:
        place = _place(self.cell) if self.places else None
        if place is None:
            self._claims += 1
            kept, left_out = self._claims <= MOST_CLAIMS, ""
        else:
            kept, left_out = self._kept((self.cell, place[0], place[1]))
        if not kept:
            return
        label = one_line(given.get("label", ""), MOST_LABEL)
        mark, detail = _parts(printed, str(given.get("label", "")))
        said = raised is None and (bool(returned) if returned is not None else mark == MARKS[0])
        arrays, numbers, unjudged = _data(kind, given, said=said)
        size = sum(array.nbytes // 8 for array in arrays.values())
        unjudged = unjudged or self._too_large(kind, arrays, size)
        arrays = {} if left_out or unjudged else arrays
        self._numbers[self.places] += size if arrays else 0
        header: dict[str, Any] = {
            "cell": self.cell,
            "kind": kind,
            "label": label,
            "detail": detail,
            "mark": mark,
            "own": one_line(given.get("detail", ""), MOST_DETAIL),
            "said": said,
            "raised": raised is not None,
            "unjudged": unjudged,
            "left_out": left_out,
            "numbers": numbers,
        }
        header |= {} if place is None else {"place": place}
        if kind != "conserved" and any(array.size > MOST_NUMBERS for array in arrays.values()):
            shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
            header["shape"] = list(shape)
            arrays = {name: _in_line(array, shape) for name, array in arrays.items()}
        self._write.claim(header, arrays, MOST_NUMBERS)

    def _kept(self, place: tuple[str, int, int]) -> tuple[bool, str]:
        """Return whether a claim made there is sent, and why without its arrays: the first one beyond a limit
        is sent.
        """
        if self._all_reported < MOST_REPORTED and self._reported[place] < MOST_AT_PLACE:
            self._reported[place] += 1
            self._all_reported += 1
            return True, ""
        first = place not in self._cut and len(self._cut) < MOST_CUT
        self._cut |= {place} if first else set()
        return first, f"more than {MOST_AT_PLACE} checks of one line, or {MOST_REPORTED} of the notebook"

    def _too_large(self, kind: str, arrays: Mapping[str, np.ndarray], size: int) -> str:
        if any(array.ndim > MOST_AXES for array in arrays.values()):
            return f"an array has more than {MOST_AXES} axes"
        try:
            largest = math.prod(np.broadcast_shapes(*(array.shape for array in arrays.values())))
        except ValueError:
            return "the shapes do not fit"
        if largest > MOST_IN_FIELD:
            return f"{largest} numbers; one check may have at most {MOST_IN_FIELD}"
        rows = [array for array in arrays.values() if array.size > MOST_NUMBERS >= len(array)]
        if kind == "conserved" and any(array.size // len(array) > MOST_NUMBERS for array in rows):
            return f"more than {MOST_NUMBERS} series"
        if self._numbers[self.places] + size > MOST_IN_ALL:
            return f"all checks together have more than {MOST_IN_ALL} numbers"
        return ""


def _in_line(array: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Return one number as it is, and an array as that of this shape without its axes."""
    return array.reshape(()) if array.size == 1 else np.broadcast_to(array, shape).reshape(-1)


class _Said:
    """A standard output that keeps what it passes on to the one before."""

    def __init__(self, stdout: Any) -> None:
        self.stdout, self.text = stdout, ""

    def write(self, text: str) -> int:
        self.text += text if len(self.text) < MOST_LABEL + 10 * MOST_DETAIL else ""
        with suppress(Exception):  # a submission can replace it
            self.stdout.write(text)
        return len(text)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stdout, name)


def _parts(printed: str, label: str) -> tuple[str, str]:
    """Return the mark and the detail of the first line of what a word has printed, if it has its form."""
    if printed[:1] not in MARKS or not printed[1:].startswith(f"  {label}"):
        return "", ""
    detail = BRACKETS.match(printed[3 + len(label) :])
    return printed[:1], one_line(detail[1], MOST_DETAIL) if detail else ""


def _data(
    kind: str, given: Mapping[str, Any], *, said: bool
) -> tuple[dict[str, np.ndarray], dict[str, float], str]:
    """Return the arrays and the numbers of a claim, or why there are none."""
    if kind not in KINDS:
        return {"passed": np.array(float(said))}, {}, ""
    arrays, numbers, known = {}, {}, kind_of(kind)
    values = list(given.values())
    try:
        for place, name in enumerate(known.arrays):
            arrays[name] = _array(kind, values[place])
        for name in known.numbers:
            numbers[name] = float(values[1] if name == "limit" else given[name])
    except OutOfTime:
        raise
    except BaseException as error:
        numbers = dict.fromkeys(known.numbers, 0.0)
        return {}, numbers, f"an argument is no number ({one_line(error, 80) or type(error).__name__})"
    return arrays, numbers, ""


def _array(kind: str, value: Any) -> np.ndarray:
    """Return an argument as the words read it: a condition as 1 or 0, else real numbers, or for ``close``
    complex ones.
    """
    if kind == "check":
        return np.array(float(bool(value)))
    array = np.asarray(value)
    if kind == "close" and array.dtype.kind == "c":
        return array.astype(complex)
    return array.real.astype(float)


def _mentioned(sources: Iterable[str]) -> tuple[set[str], set[str]]:
    """Return the course's packages that the sources mention, and the modules of theirs that these import."""
    files = [path for folder in course for path in Path(folder).glob("[!_.]*")]
    packages = sorted(path.stem for path in files if path.suffix == ".py" or path.is_dir())
    if not packages:
        return set(), set()
    pattern = re.compile(rf"\b({'|'.join(packages)})\b")
    texts = {source: set(pattern.findall(source)) for source in sources}
    nodes = [node for source, found in texts.items() if found for node in nodes_of(source)]
    modules = set[str]()
    for node in nodes:
        if isinstance(node, ast.Import):
            modules |= {one.name for one in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            modules |= {node.module, *(f"{node.module}.{one.name}" for one in node.names)}
    tops = set[str]().union(*texts.values())
    return tops, {name for name in modules if name.partition(".")[0] in tops}


def _import(name: str) -> None:
    """Import a module of the course. Raises AuthorError if code of the course fails or does not end; a module
    that does not exist is the importing cell's error.
    """

    def load() -> None:
        importlib.import_module(name)

    error, folders = limited(load, Budget(IMPORT_S)), tuple(course)
    if isinstance(error, SyntaxError) and str(error.filename).startswith(folders):
        raise AuthorError(_failed(str(error.filename), error.lineno, error)) from error
    frames = [] if error is None else traceback.extract_tb(error.__traceback__)
    at = next((frame for frame in reversed(frames) if frame.filename.startswith(folders)), None)
    if at is not None and error is not None:
        raise AuthorError(_failed(at.filename, at.lineno, error)) from error


def _failed(filename: str, line: int | None, error: BaseException) -> str:
    folder = next(folder for folder in course if filename.startswith(folder))
    where = f"course{filename.removeprefix(folder)}"
    if isinstance(error, OutOfTime):
        return f"{where}, line {line}: importing it takes more than {IMPORT_S:g} s"
    message = error.msg if isinstance(error, SyntaxError) else error
    return f"{where}, line {line}: {type(error).__name__}: {one_line(message, 200)}"


def _place(cell: str) -> list[int]:
    """Return line and column, of the cell that runs, of the call that is in progress; [0, 0] if it does not
    run.
    """
    frame: FrameType | None = _getframe()
    while frame is not None and frame.f_code.co_filename != cell:
        frame = frame.f_back
    if frame is None:
        return [0, 0]
    line, _, column, _ = list(frame.f_code.co_positions())[frame.f_lasti // 2]
    return [line or 0, column or 0]
