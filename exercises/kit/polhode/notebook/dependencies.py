"""The names that the requested functions depend on, and an order of their sources that runs."""

import ast
from collections.abc import Collection, Iterable, Iterator
from functools import lru_cache

from polhode.notebook.name_sources import Missing, Source, Sources

_OUTSIDE = {
    "open",
    "input",
    "get_ipython",
    "os",
    "io",
    "pathlib",
    "Path",
    "shutil",
    "glob",
    "tempfile",
    "subprocess",
    "sqlite3",
}
_OUTSIDE |= {
    "socket",
    "ssl",
    "urllib",
    "http",
    "requests",
    "urlopen",
    "urlretrieve",
    "imread",
    "imsave",
    "loadtxt",
    "genfromtxt",
}
_OUTSIDE_METHODS = {
    "load",
    "fromfile",
    "memmap",
    "loadmat",
    "savemat",
    "save",
    "savez",
    "savetxt",
    "savefig",
    "tofile",
    "to_csv",
}
"""Names that reach files or the network. A statement that uses one, or runs code that does, is not sent."""

_REMEDY = "compute it without them, or write the numbers into a cell"
_AGAIN = "run that cell again, or define it there with def"


class Bundling:
    """The sources that the names ``requested`` need, and the names that are ``missing`` (name → sentence)."""

    def __init__(self, sources: Sources, requested: Collection[str], given: Collection[str]) -> None:
        self._sources, self._requested, self._given = sources, requested, given
        self._found: dict[str, Source] = {}
        self.missing: dict[str, str] = {}
        self._follow()
        while lost := {name: why for name, source in self._found.items() if (why := self._refusal(source))}:
            # Report the cause first; names that only depend on it are dropped in the next round.
            runs = {name: self._reached(self._found[name].names.now).keys() - {name} for name in lost}
            causes = [name for name in lost if not runs[name] & lost.keys()] or list(lost)
            for name in causes:
                self.missing[name] = lost[name]
                del self._found[name]

    def left_out(self) -> Iterator[tuple[str, str, str]]:
        """Yield each missing name that a sent source needs: the name, the source's name, and why it is not
        sent.
        """
        reported: set[str] = set()
        for source in self._sent():
            for name in sorted(_needs(source) & self.missing.keys() - reported):
                reported.add(name)
                instead = f" (the server's own `{name}` is used)" if name in self._given else ""
                yield name, source.name, self.missing[name] + instead

    def text(self) -> str:
        """Return imports, then values and definitions, each after what it needs when it runs."""
        sent = self._sent()
        imports = {s.text for s in sent if s.kind == "import"}
        ordered = list(dict.fromkeys(s.text for s in self._in_order([s for s in sent if s.kind != "import"])))
        extra = {
            line for s in sent if s.kind == "import" for line in self._sources.submodules(s.name, ordered)
        }
        head = "\n".join([*self._sources.history.futures, *sorted(imports | extra)])
        text = ""
        for before, after in zip(["", *ordered], ordered, strict=False):
            both_short = before and "\n" not in before + after
            text += ("\n" if both_short else "\n\n\n" if before else "") + after
        return "\n\n\n".join(part for part in (head, text) if part) + "\n"

    def _follow(self) -> None:
        waiting = list(self._requested)
        while waiting:
            name = waiting.pop(0)
            if name in self._found or name in self.missing:
                continue
            found = self._sources.find(name)
            if isinstance(found, Missing):
                self.missing[name] = found.sentence
            elif found is None and name in self._requested:
                self.missing[name] = (
                    f"`{name}` is built in, not your function: define one with that name in a cell"
                )
            elif found:
                self._found[name] = found
                waiting += sorted(_needs(found))

    def _refusal(self, source: Source) -> str | None:
        """Return why running this text would fail or would not give the current value; None if it would."""
        runs = self._reached(source.names.now).keys() if source.kind == "statement" else source.names.now
        lost = sorted(name for name in runs if name in self.missing and name not in self._given)
        if lost:
            return f"`{source.name}` is made with `{lost[0]}`, which cannot be sent: {self.missing[lost[0]]}"
        if source.kind not in ("statement", "definition"):
            return None
        texts = [source.text, *(self._found[name].text for name in sorted(runs & self._found.keys()))]
        if source.kind == "statement" and any(_reaches_outside(text) for text in texts):
            return (
                f"`{source.name}` is computed from a file or the network, which the server cannot use:"
                f" {_REMEDY}"
            )
        if self._sources.is_outdated(source, texts):
            return f"`{source.name}` has changed since its cell ran, so it cannot be sent: {_AGAIN}"
        return None

    def _reached(self, names: Iterable[str]) -> dict[str, None]:
        """Return the names and all they need, each behind what it needs."""
        done: dict[str, None] = {}
        entered: set[str] = set()

        def enter(name: str) -> None:
            if name not in entered:
                entered.add(name)
                for needed in sorted(_needs(self._found[name])) if name in self._found else ():
                    enter(needed)
                done[name] = None

        for name in names:
            enter(name)
        return done

    def _sent(self) -> list[Source]:
        """Return the sources reached from the requested names,
        each helper before the functions that use it.
        """
        sent = [self._found[name] for name in self._reached(self._requested) if name in self._found]
        return sorted(sent, key=lambda source: source.kind != "value")

    def _in_order(self, sources: list[Source]) -> Iterator[Source]:
        """Yield the sources in the given order, changed only where one must run before another.

        A text comes after the names it runs, and after other texts that bind its name.
        """
        waiting = {s.name: s for s in sources}
        first: dict[str, set[str]] = {}
        for s in sources:
            binding = {
                other.name for other in sources if s.name in other.names.bound and other.text != s.text
            }
            first[s.name] = (self._reached(s.names.now).keys() | binding) - {s.name}
        while waiting:
            free = (name for name in waiting if not first[name] & waiting.keys())
            name = next(free, None) or next(iter(waiting))
            yield waiting.pop(name)


def _needs(source: Source) -> frozenset[str]:
    return source.names.now | source.names.later - {source.name}


@lru_cache(maxsize=2048)
def _reaches_outside(text: str) -> bool:
    return any(word in _OUTSIDE for word in _words(text)) or any(
        _is_reading(word) for word in _words(text, names=False)
    )


def _is_reading(word: str) -> bool:
    return word in _OUTSIDE_METHODS or word.startswith("read_")


def _words(text: str, names: bool = True) -> Iterator[str]:
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Name) and names:
            yield node.id
        elif isinstance(node, ast.Attribute):
            yield node.attr
        elif isinstance(node, ast.Import | ast.ImportFrom):
            modules = [getattr(node, "module", None) or "", *(alias.name for alias in node.names)]
            yield from (part for module in modules for part in module.split("."))
