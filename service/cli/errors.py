"""What a command cannot do, and how the errors of all commands are printed."""

import sys
import traceback

SENTENCES = {
    "CommandError", "InvalidAssignment", "NoAssignment", "InvalidNotebook", "UnknownExercise", "SystemFault",
    "IsolationUnavailable", "DatabaseUnavailable", "WrongSchema", "BackupError", "BadRoster", "InvalidName",
    "InvalidPassword", "OSError",
}  # fmt: skip
"""The exceptions, by name, whose text is a sentence for the user. Importing their modules may itself have
failed.
"""


class CommandError(ValueError):
    """A command cannot do what it is asked; the message says why."""


def print_error(error: Exception) -> None:
    """Print a sentence for each error of the user or the machine, or the traceback of any other error."""
    if type(error).__name__ == "ValidationError" and getattr(error, "title", "") == "Settings":
        for wrong in error.errors(include_input=False, include_url=False):  # type: ignore[attr-defined]
            # an alias has the prefix already
            name = "_".join(map(str, wrong["loc"])).upper().removeprefix("POLHODE_")
            place = f"POLHODE_{name}: " if name else ""  # an error of several settings names them itself
            print(f"polhode: {place}{wrong['msg'].removeprefix('Value error, ')}", file=sys.stderr)
    elif SENTENCES & {kind.__name__ for kind in type(error).__mro__}:
        named = isinstance(error, OSError) and error.filename is not None and error.strerror
        sentence = f"{error.filename}: {error.strerror}" if named else error  # type: ignore[attr-defined]
        print(f"polhode: {sentence}", file=sys.stderr)
    elif isinstance(error, ModuleNotFoundError) and (error.name or "").partition(".")[0] == "polhode":
        print("polhode: the students' kit is not installed here: install polhode-kit again", file=sys.stderr)
    else:
        traceback.print_exc()
