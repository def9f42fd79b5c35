"""A folder of reports with pages to browse."""

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import quote

from exercises.authoring.assignments.assignment import Assignment
from polhode.report.dataclass_json import document
from service.cli.output_file import write
from service.formats import html
from service.formats.filenames import UniqueNames
from service.grading.graded_file import GradedFile


class ReportFolder:
    """A folder ``path`` with index.html and a subfolder of reports for each file.

    A subfolder is named after the file, or after its whole path if several files have the same name.
    """

    def __init__(self, path: Path, files: Sequence[Path]) -> None:
        stems, names = Counter(file.stem for file in files), UniqueNames(["index.html"])
        whole = {
            f: f.stem if stems[f.stem] == 1 else "_".join(p for p in f.parts if p not in ("/", ".."))
            for f in files
        }
        self._path, self._names = path, {file: names.give(name) for file, name in whole.items()}

    def add(self, file: GradedFile) -> None:
        """Write a file's report as text, JSON and HTML, and its pictures."""
        folder = self._path / self._names[file.file]
        write(folder / "index.html", html.page(file))
        if file.report is None:
            write(folder / "report.txt", f"{file.why}\n")
            return
        write(folder / "report.txt", file.report.text())
        write(folder / "report.json", json.dumps(document(file.report), ensure_ascii=False, indent=1))
        for name, content in file.pictures.items():
            write(folder / name, content)

    def write_index(self, files: Sequence[GradedFile], assignment: Assignment) -> None:
        """Write index.html."""
        pages = {file: f"{quote(name)}/index.html" for file, name in self._names.items()}
        write(self._path / "index.html", html.index(files, assignment, pages))
