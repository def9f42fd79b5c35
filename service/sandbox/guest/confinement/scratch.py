"""The scratch folder of a child: its working folder and home, and the only folder that it can write to.

The zygote makes a new one for each child, puts the assignment's data files there, watches while the child
runs how much it holds, and removes it when the child has exited. No child can make a link or a device, or
reach the folder of another. What opens, counts or removes its files follows no link all the same.
"""

import functools
import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib.machinery import (
    EXTENSION_SUFFIXES,
    SOURCE_SUFFIXES,
    ExtensionFileLoader,
    FileFinder,
    ModuleSpec,
    SourceFileLoader,
)
from pathlib import Path
from types import ModuleType
from typing import Any

MIB = 1 << 20
MOST_BYTES, MOST_FILE, MOST_ENTRIES, MOST_DEPTH = 32 * MIB, 16 * MIB, 1000, 64
MOST_COPIED = 8 * MIB  # of data files together; the others are links to files that can only be read
ROOM = MOST_BYTES + MOST_COPIED  # the size of a file system for the folders of a zygote
WATCH_S = 0.1
FULL = 94  # exit code of a child whose folder is full
MOST_RESERVE = 512 * MIB
NO_ROOM = (
    f"the scratch folder of the grader holds at most {MOST_BYTES // MIB} MiB and {MOST_ENTRIES} files,"
    f" each of at most {MOST_FILE // MIB} MiB: write less"
)
USER = "student"


class Scratch:
    """A new scratch folder in the folder ``room``, which belongs to the zygotes. Its name is random."""

    def __init__(self, room: str) -> None:
        self.path = os.path.join(room, os.urandom(8).hex())
        os.mkdir(self.path, 0o700)
        self._most_bytes, self._most_entries = MOST_BYTES, MOST_ENTRIES
        self._reserve = 0

    def fill(self, data: str) -> None:
        """Put the files below the folder ``data`` there."""
        copied = 0
        for file in sorted(Path(data).rglob("*")):
            name = file.relative_to(data)
            if not file.is_file():
                continue
            target, size = Path(self.path, name), file.stat().st_size
            target.parent.mkdir(parents=True, exist_ok=True)
            if copied + size > MOST_COPIED:
                target.symlink_to(file.absolute())
            else:
                target.write_bytes(file.read_bytes())
                copied += size
        sizes = [*_sizes(self.path)]  # a child may add to these
        self._most_bytes, self._most_entries = MOST_BYTES + sum(sizes), MOST_ENTRIES + len(sizes)
        system = os.statvfs(self.path)
        small = system.f_blocks * system.f_frsize <= 2 * ROOM  # it has no other files
        self._reserve = 0 if small else min(MOST_RESERVE, system.f_bavail * system.f_frsize // 4)

    def enter(self) -> None:
        """Make it the working folder, home and folder for temporary files of this process, and the first one
        that modules are imported from.
        """
        _own.append(self)
        os.chdir(self.path)
        os.environ |= {"HOME": self.path, "TMPDIR": self.path, "USER": USER, "LOGNAME": USER}
        if "tempfile" in sys.modules:
            vars(sys.modules["tempfile"])["tempdir"] = None  # found again when it is asked for
        sys.addaudithook(_make_folder)
        sys.path.insert(0, "")
        sys.path_hooks.insert(0, self._finder)
        for name in ("chmod", "utime"):
            setattr(os, name, self._without_effect(getattr(os, name)))

    def _finder(self, path: str) -> "_Finder":
        if not self._has(path):
            raise ImportError(path)
        return _Finder(path, (ExtensionFileLoader, EXTENSION_SUFFIXES), (SourceFileLoader, SOURCE_SUFFIXES))

    def _without_effect(self, change: Callable[..., None]) -> Callable[..., None]:
        """Return a function that does nothing instead of failing for a file of this folder. A child may not
        change modes and times, but copying a file does so too.
        """

        @functools.wraps(change)
        def tried(path: Any, *args: Any, **kwargs: Any) -> None:
            try:
                change(path, *args, **kwargs)
            except PermissionError:
                os.stat(path)  # raises FileNotFoundError if there is none
                if isinstance(path, int) or not self._has(os.path.realpath(os.fsdecode(path))):
                    raise

        return tried

    def _has(self, path: str) -> bool:
        return path == self.path or path.startswith(self.path + os.sep)

    def is_full(self) -> bool:
        """Return whether the folder holds more than a child may write. It may be changed meanwhile."""
        size = 0
        try:
            for number, found in enumerate(_sizes(self.path), start=1):
                size += found
                if size > self._most_bytes or number > self._most_entries:
                    return True
        except PermissionError:  # a folder that its maker has closed
            return True
        return False

    def fills_the_disk(self) -> bool:
        """Return whether its file system has become nearly full: a child can keep files that have no name any
        more, which are not counted.
        """
        system = os.statvfs(self.path)
        return system.f_bavail * system.f_frsize < self._reserve

    def remove(self) -> None:
        """Remove the folder, when no process has it any more. Raises OSError if something is left."""
        remove(self.path)


_own = list[Scratch]()  # of this process


def end_if_full() -> None:
    """End this process if its scratch folder is full. The zygote would do so soon, but this one knows which
    statement has filled it.
    """
    with suppress(Exception):  # a submission may have no descriptor left, or replace what this uses
        if any(scratch.is_full() for scratch in _own):
            os._exit(FULL)


def _make_folder(event: str, arguments: tuple[Any, ...]) -> None:
    """Make the folder of a file that is to be written: the student's disk may have one of that name."""
    if event != "open" or not isinstance(arguments[0], str):
        return
    path, _, flags = arguments
    folder = os.path.dirname(path)
    if folder and not os.path.isabs(folder) and isinstance(flags, int) and flags & os.O_CREAT:
        with suppress(OSError):
            os.makedirs(folder, exist_ok=True)


class _Finder(FileFinder):
    """A finder of modules that may have been written a moment ago, which FileFinder can overlook."""

    def find_spec(self, fullname: str, target: ModuleType | None = None) -> ModuleSpec | None:
        self.invalidate_caches()
        return super().find_spec(fullname, target)


def remove(folder: str) -> None:
    """Remove a folder with all that is in it. Raises OSError if something is left.

    Folders in it are first moved beside it: they can be nested deeper than a path can be long.
    """
    parent, name = os.path.split(folder)
    with _opened(parent) as beside:
        names = [name]
        for one in names:
            with _opened(one, beside) as opened:
                with os.scandir(opened) as found:
                    entries = list(found)
                for entry in entries:
                    if not entry.is_dir(follow_symlinks=False):
                        os.unlink(entry.name, dir_fd=opened)
                        continue
                    os.chmod(entry.name, 0o700, dir_fd=opened)
                    names.append(f"{name}.{os.urandom(8).hex()}")
                    os.rename(entry.name, names[-1], src_dir_fd=opened, dst_dir_fd=beside)
            os.rmdir(one, dir_fd=beside)


def _sizes(folder: str, parent: int | None = None, depth: int = 0) -> Iterator[int]:
    """Yield the size of each file below a folder, and 0 for each folder. Raises PermissionError if one cannot
    be opened or is nested too deep.
    """
    if depth > MOST_DEPTH:
        raise PermissionError
    try:
        with _opened(folder, parent) as opened, os.scandir(opened) as entries:
            for entry in entries:
                if entry.is_dir(follow_symlinks=False):
                    yield 0
                    yield from _sizes(entry.name, opened, depth + 1)
                else:
                    yield _size(entry)
    except (FileNotFoundError, NotADirectoryError):
        return


def _size(entry: "os.DirEntry[str]") -> int:
    try:
        return entry.stat(follow_symlinks=False).st_size
    except FileNotFoundError:
        return 0


@contextmanager
def _opened(folder: str, parent: int | None = None) -> Iterator[int]:
    """Open a folder, not a link to one."""
    fd = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC, dir_fd=parent)
    try:
        yield fd
    finally:
        os.close(fd)
