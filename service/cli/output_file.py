"""A file that a command writes: completely or not at all."""

import os
from pathlib import Path


def write(file: Path, content: str | bytes) -> None:
    """Write a file completely or not at all: if writing fails, as on a full disk, the previous content
    remains.

    Pipes and files in /dev are written in place; a symbolic link is replaced. Undecodable file names in the
    text are escaped.
    """
    whole = content.encode(errors="backslashreplace") if isinstance(content, str) else content
    if file.is_relative_to("/dev") or (file.exists() and not file.is_file() and not file.is_dir()):
        file.write_bytes(whole)
        return
    file.parent.mkdir(parents=True, exist_ok=True)
    part = file.with_name(f"{file.name}.part{os.getpid()}")
    try:
        part.write_bytes(whole)
        part.replace(file)
    finally:
        part.unlink(missing_ok=True)
