"""Run ``polhode`` in this process: the same exit code and output as of a process of its own, without a second
of imports.
"""

import contextlib
import io
from typing import NamedTuple

from service.cli.__main__ import main


class Result(NamedTuple):
    """How a command ended, and what it wrote."""

    returncode: int
    stdout: str
    stderr: str


def polhode(*arguments, encoding="utf-8", stderr=None):
    """Run the command with streams as Python opens them; ``stderr`` replaces the one whose text is
    returned.
    """
    out = io.TextIOWrapper(io.BytesIO(), encoding=encoding, write_through=True)
    err = io.TextIOWrapper(io.BytesIO(), encoding=encoding, errors="backslashreplace", write_through=True)
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(stderr or err):
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as end:  # argparse
            code = end.code
    return Result(code, *(stream.buffer.getvalue().decode(encoding) for stream in (out, err)))
