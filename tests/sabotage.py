"""Measure how strong the tests are: break the product on purpose, one line at a time, and see which test
fails.

Run ``python -m tests.sabotage [NAME…] [--jobs N] [--list]``, or ``make sabotage``. Each job works on its own
copy of the files that git tracks or would track. A breakage is caught if pytest exits with 1 when it runs the
tests that the breakage names: functions, which may be slow, or the fast tests of whole files. If these tests
pass, the whole selection of ``make test`` runs in the copy, and the breakage counts as caught by other tests
or not at all. Exit codes: 0 if the named tests caught every breakage, 1 if not, 2 if the list is wrong or its
tests fail without a breakage.
"""

import argparse
import contextlib
import os
import queue
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tests.support.breakages import BREAKAGES, Breakage

ROOT = Path(__file__).parents[1]
SELECTION = "not slow and not exhaustive"
PYTEST = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider"]  # pyproject.toml has -q already
# every breakage makes it fail: the text to replace is not there any more
LIST_TEST = "tests/project/test_sabotage.py"
SHARED = ("--numprocesses", "2", "--dist", "loadfile", "--no-loadscope-reorder")  # as make test does
IMPORTED = ("service", "exercises", "reference", "polhode", "tests.support.breakages")
SIGNALS = (signal.SIGINT, signal.SIGTERM)
LIMIT_S, WHOLE_LIMIT_S = 300.0, 1800.0
CAUGHT, UNNAMED, ELSEWHERE = "caught", "not caught by the tests named", "caught by other tests"
MISSED, ERROR = "NOT CAUGHT", "error"
MEANING = {
    2: "interrupted, such as by an import that fails",
    3: "internal error of pytest",
    4: "usage error",
    5: "no test was selected",
}
FAILED = re.compile(r"^(?:FAILED|ERROR) (\S+?)(?:\[.*)?(?: - .*)?$", re.MULTILINE)


class Stopped(Exception):
    """The run was interrupted."""


@dataclass(frozen=True)
class Run:
    """One finished pytest run; ``code`` is None if it was ended after its limit."""

    code: int | None
    output: str

    @property
    def failed(self) -> list[str]:
        """The tests that failed, without the values of their parameters."""
        return list(dict.fromkeys(FAILED.findall(self.output)))


@dataclass(frozen=True)
class Result:
    """What became of a breakage: ``how`` is one of the constants above, ``by`` the failed tests or a
    sentence.
    """

    breakage: Breakage
    how: str
    by: str
    seconds: float


@dataclass
class Copy:
    """A copy of the repository in ``folder``, in which one breakage at a time is made and taken back."""

    folder: Path
    stop: threading.Event = field(default_factory=threading.Event)

    @property
    def tree(self) -> Path:
        """The copied files."""
        return self.folder / "tree"

    def make(self) -> None:
        """Copy every file that git tracks or would track, and commit them in the copy, which some tests
        clone.
        """
        listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        names = subprocess.run(listed, cwd=ROOT, capture_output=True, text=True, check=True).stdout
        for name in filter(None, names.split("\0")):
            if (ROOT / name).is_file():
                (self.tree / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, self.tree / name)
        author = ["-c", "user.name=polhode", "-c", "user.email=polhode@localhost"]
        for command in (["init", "-q"], ["add", "--all"], [*author, "commit", "-qm", "copy"]):
            subprocess.run(["git", *command], cwd=self.tree, check=True)

    def check_imports(self) -> None:
        """Raise AssertionError unless Python imports the copy's packages, and not those of an editable
        installation.
        """
        told = (
            "import importlib, sys\nfor name in sys.argv[1:]: print(importlib.import_module(name).__file__)"
        )
        command = [sys.executable, "-c", told, *IMPORTED]
        found = subprocess.run(
            command, cwd=self.tree, env=self._environment(), capture_output=True, text=True, check=True
        ).stdout
        for line in found.splitlines():
            assert Path(line).is_relative_to(self.tree), (
                f"{line} is imported instead of the copy in {self.tree}"
            )

    @contextlib.contextmanager
    def broken(self, breakage: Breakage) -> Iterator[None]:
        """Make the breakage, and take it back afterwards."""
        file = self.tree / breakage.file
        text, stat = file.read_text(encoding="utf-8"), file.stat()
        file.write_text(text.replace(breakage.old, breakage.new), encoding="utf-8")
        try:
            yield
        finally:
            file.write_text(text, encoding="utf-8")
            # else the broken bytecode could be taken for the file's
            os.utime(file, ns=(stat.st_atime_ns, stat.st_mtime_ns))

    def pytest(self, *arguments: str, limit_s: float = LIMIT_S) -> Run:
        """Run pytest in the copy; Stopped if the whole run is interrupted meanwhile."""
        command = [*PYTEST, f"--basetemp={self.folder / 'pytest'}", *arguments]
        with (self.folder / "output").open("w+", encoding="utf-8", errors="replace") as output:
            process = subprocess.Popen(
                command,
                cwd=self.tree,
                env=self._environment(),
                stdout=output,
                stderr=output,
                start_new_session=True,
            )
            until = time.monotonic() + limit_s
            try:
                while process.poll() is None and time.monotonic() < until and not self.stop.is_set():
                    time.sleep(0.05)
            finally:
                ended = process.poll() is not None
                if not ended:
                    _end(process)
            if self.stop.is_set():
                raise Stopped
            output.seek(0)
            return Run(process.returncode if ended else None, output.read())

    def _environment(self) -> dict[str, str]:
        own = {
            "PYTHONPATH": f"{self.tree}:{self.tree / 'exercises/kit'}",
            "OMP_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
        }
        kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
        return kept | own | {"COLUMNS": "1000"}  # names of tests are not cut


def _end(process: "subprocess.Popen[bytes]") -> None:
    """Interrupt pytest, so that it stops the servers and databases of its fixtures; kill it if it does not
    end.
    """
    for how, patience_s in ((signal.SIGINT, 30.0), (signal.SIGKILL, None)):
        os.killpg(process.pid, how)
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(patience_s)
            return


def errors(breakages: Iterable[Breakage]) -> list[str]:
    """What is wrong with the list: files, texts and tests that are not there, names and texts that are there
    twice.
    """
    found, names = [], set()
    for one in breakages:
        if one.name in names:
            found.append(f"{one.name}: the name is there twice")
        names.add(one.name)
        file = ROOT / one.file
        count = file.read_text(encoding="utf-8").count(one.old) if file.is_file() else 0
        if count != 1:
            found.append(f"{one.name}: its text is {count} times in {one.file}, not once")
        if one.old == one.new or not one.tests:
            found.append(f"{one.name}: it changes nothing or names no test")
        for test in one.tests:
            path, _, function = test.partition("::")
            text = (ROOT / path).read_text(encoding="utf-8") if (ROOT / path).is_file() else ""
            if not text or (function and not re.search(rf"^def {re.escape(function)}\(", text, re.MULTILINE)):
                found.append(f"{one.name}: there is no test {test}")
    return found


def selection(tests: Sequence[str]) -> str:
    """Return pytest's expression for named tests: slow ones are among them if all are functions."""
    return "not exhaustive" if all("::" in test for test in tests) else SELECTION


def untouched(copy: Copy, tests: Sequence[str]) -> list[str]:
    """Why these tests cannot serve: they fail without any breakage, or pytest does not select them."""
    functions, files = [test for test in tests if "::" in test], [test for test in tests if "::" not in test]
    return [why for same in (functions, files) if same for why in _untouched(copy, same)]


def _untouched(copy: Copy, tests: Sequence[str]) -> list[str]:
    collected = copy.pytest("--collect-only", "-m", selection(tests), *tests)
    unselected = [
        test
        for test in tests
        if not re.search(rf"^{re.escape(test)}(?:::|\[|$)", collected.output, re.MULTILINE)
    ]
    if collected.code != 0 or unselected:
        return [f"pytest does not select {test}" for test in unselected] or [collected.output]
    run = copy.pytest(*SHARED, "-m", selection(tests), *tests, limit_s=WHOLE_LIMIT_S)
    return (
        []
        if run.code == 0
        else [f"without any breakage: {line}" for line in run.failed or [run.output[-2000:]]]
    )


def attempt(copy: Copy, one: Breakage, *, others: bool = True) -> Result:
    """Make the breakage in the copy, run its tests, and where these pass and ``others`` are wanted all of
    them.
    """
    began = time.monotonic()

    def result(how: str, by: str) -> Result:
        return Result(one, how, by, time.monotonic() - began)

    with copy.broken(one):
        run = copy.pytest("-x", "-m", selection(one.tests), *one.tests)
        if run.code == 1:
            return result(CAUGHT, ", ".join(run.failed))
        if run.code is None:
            return result(ERROR, f"its tests did not end within {LIMIT_S:g} s")
        if run.code != 0:
            return result(ERROR, f"pytest exited with {run.code} ({MEANING.get(run.code, 'unknown')})")
        if not others:
            return result(UNNAMED, "")
        run = copy.pytest(*SHARED, "-m", SELECTION, f"--ignore={LIST_TEST}", limit_s=WHOLE_LIMIT_S)
        if run.code == 1:
            return result(ELSEWHERE, ", ".join(run.failed[:3]))
        return (
            result(MISSED, "")
            if run.code == 0
            else result(ERROR, f"pytest over everything exited with {run.code}")
        )


def sabotage(breakages: Sequence[Breakage], jobs: int, *, others: bool = True) -> list[Result] | None:
    """Try every breakage and return the results in their order;
    None where the tests fail without a breakage.
    """
    stop, waiting, found = threading.Event(), queue.Queue[Breakage](), dict[str, Result]()
    failures: list[BaseException] = []
    for one in breakages:
        waiting.put(one)

    def work(copy: Copy) -> None:
        try:
            while not stop.is_set():
                result = attempt(copy, waiting.get_nowait(), others=others)
                found[result.breakage.name] = result
                print(f"{len(found):3}/{len(breakages)}  {result.how}: {result.breakage.name}", flush=True)
        except (queue.Empty, Stopped):
            pass
        except BaseException as error:  # told by the main thread
            failures.append(error)
            stop.set()

    with tempfile.TemporaryDirectory(prefix="polhode-sabotage-", ignore_cleanup_errors=True) as folder:
        Path(folder).chmod(0o755)  # the guest is another user, who must be able to read the copy
        copies = [Copy(Path(folder) / f"job{number}", stop) for number in range(min(jobs, len(breakages)))]
        threads = [threading.Thread(target=work, args=(copy,)) for copy in copies]
        try:
            for copy in copies:
                copy.make()
            copies[0].check_imports()
            tests = sorted({test for one in breakages for test in one.tests})
            print(f"running the {len(tests)} named tests and files without any breakage", flush=True)
            if why := untouched(copies[0], tests):
                print("\n".join(why), file=sys.stderr)
                return None
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
        finally:  # also after an interrupt
            stop.set()
            for thread in threads:
                if thread.ident is not None:
                    thread.join()
    if failures:
        raise failures[0]
    return [found[one.name] for one in breakages]


def table(results: Sequence[Result]) -> str:
    """The results as lines of columns: breakage, file, how and by which test it was caught, seconds."""
    rows = [("breakage", "file", "result", "seconds", "by")]
    rows += [(r.breakage.name, r.breakage.file, r.how, f"{r.seconds:.0f}", r.by) for r in results]
    widths = [max(len(row[k]) for row in rows) for k in range(4)]
    return "\n".join(
        "  ".join([*(cell.ljust(width) for cell, width in zip(row, widths, strict=False)), row[4]])
        for row in rows
    )


def _interrupt(signum: int, frame: object) -> None:
    """Raise KeyboardInterrupt once; what follows removes the copies,
    and a second signal must not stop that.
    """
    for how in SIGNALS:
        signal.signal(how, signal.SIG_IGN)
    raise KeyboardInterrupt


def main(arguments: Sequence[str] | None = None) -> int:
    """Try the breakages of these names, by default all of them."""
    parser = argparse.ArgumentParser(prog="python -m tests.sabotage", description=__doc__.partition("\n")[0])
    parser.add_argument(
        "names",
        nargs="*",
        metavar="NAME",
        help="try the breakages whose name or file contains NAME; default: all",
    )
    parser.add_argument("--jobs", type=int, default=2, help="how many copies to work on at the same time (2)")
    parser.add_argument(
        "--named-only", action="store_true", help="do not run the other tests where those named pass"
    )
    parser.add_argument("--list", action="store_true", help="print the names and files, and try nothing")
    given = parser.parse_args(arguments)
    chosen = [
        one
        for one in BREAKAGES
        if not given.names or any(name in f"{one.name} {one.file}" for name in given.names)
    ]
    if wrong := errors(BREAKAGES) or ([] if chosen else ["no breakage of that name"]):
        print("\n".join(wrong), file=sys.stderr)
        return 2
    if given.list:
        print("\n".join(f"{one.file}: {one.name}" for one in chosen))
        return 0
    for how in SIGNALS:  # set also where a shell has SIGINT ignored
        signal.signal(how, _interrupt)
    try:
        results = sabotage(chosen, max(1, given.jobs), others=not given.named_only)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
    if results is None:
        return 2
    caught = sum(result.how == CAUGHT for result in results)
    print(
        f"\n{table(results)}\n\n{caught} of {len(results)} breakages were caught by the tests named for them"
    )
    return 0 if caught == len(results) else 1


if __name__ == "__main__":
    sys.exit(main())
