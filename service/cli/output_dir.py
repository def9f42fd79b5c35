"""What is written of a batch: whole files or none, and a folder with every report, its pictures and pages to look at."""

import json
import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import quote

from ecp.document import document
from exercises.assignment import Assignment
from service.formats import html
from service.formats.filenames import UniqueNames
from service.grading.result import GradedFile


def write(file: Path, content: str | bytes) -> None:
    """Write a file as a whole: where that fails, as on a full disk, what was there before is still there.

    What is no file, such as a pipe or anything in /dev, is written to and not replaced; a link is replaced, wherever it leads.
    Names that are not UTF-8 are told as they can be.
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


class OutputDir:
    """Reports below ``path``, a folder for each file named like it; where several are, by their whole paths; and index.html."""

    def __init__(self, path: Path, files: Sequence[Path]) -> None:
        stems, names = Counter(file.stem for file in files), UniqueNames(["index.html"])
        whole = {f: f.stem if stems[f.stem] == 1 else "_".join(p for p in f.parts if p not in ("/", "..")) for f in files}
        self._path, self._names = path, {file: names.give(name) for file, name in whole.items()}

    def add(self, file: GradedFile) -> None:
        """Write report.txt, report.json, every picture, and the page that shows them."""
        folder = self._path / self._names[file.file]
        write(folder / "index.html", html.page(file))
        if file.report is None:
            write(folder / "report.txt", f"{file.why}\n")
            return
        write(folder / "report.txt", file.report.text())
        write(folder / "report.json", json.dumps(document(file.report), ensure_ascii=False, indent=1))
        for name, content in file.pictures.items():
            write(folder / name, content)

    def end(self, files: Sequence[GradedFile], assignment: Assignment) -> None:
        """Write index.html."""
        pages = {file: f"{quote(name)}/index.html" for file, name in self._names.items()}
        write(self._path / "index.html", html.index(files, assignment, pages))
