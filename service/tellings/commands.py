"""Workflow commands of GitHub Actions: what a step prints and the runner takes for more than text.

The rules are those of the runner's parser (actions/runner, ActionCommand) and of the toolkit that writes commands (actions/toolkit,
core/command): a line is a command if after blanks it begins with ::, or holds ##[ anywhere.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Annotation:
    """An error at a line of a file, or at none of them."""

    title: str
    message: str
    file: str | None = None
    line: int | None = None

    def __str__(self) -> str:
        """As a workflow command, of one line."""
        about = {"file": self.file, "line": self.line, "title": self.title}
        told = ",".join(f"{key}={_property(str(value))}" for key, value in about.items() if value is not None)
        return f"::error {told}::{_data(self.message)}"


def unheard(text: str, token: str) -> str:
    """The text for a workflow's log, in which the runner takes no line for a command; nobody may know the ``token`` before."""
    return f"::stop-commands::{token}\n{text}\n::{token}::"


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
