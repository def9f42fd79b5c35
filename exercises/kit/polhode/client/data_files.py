"""The data files of an assignment."""

from pathlib import Path


def copy_data(home: Path) -> None:
    """Copy the data files in ``home`` to the current folder, except those that are there already.

    Print the name of each file that differs from the one there or cannot be written.
    """
    for source in sorted(path for path in home.rglob("*") if path.is_file()):
        name = source.relative_to(home)
        try:
            if not name.exists():
                name.parent.mkdir(parents=True, exist_ok=True)
                name.write_bytes(source.read_bytes())
            elif name.read_bytes() != source.read_bytes():
                print(
                    f"{name} in {Path.cwd()} differs from the course's file: rename yours and run this cell"
                    " again."
                )
        except OSError as error:
            print(f"{name} was not written to {Path.cwd()} ({error.strerror}): copy it there from {source}.")
