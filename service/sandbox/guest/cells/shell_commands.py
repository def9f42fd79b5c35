"""Commands of a shell, which the sandbox does not have."""

import os
import shlex


def run_command(command: object) -> int:
    """Make the folders of a ``mkdir``. Say of every other command that it was not run. Return its status."""
    text = str(command).strip()
    try:
        program, *folders = shlex.split(text)
    except ValueError:
        program, folders = text, []
    if program == "mkdir" and not any(mark in text for mark in "|&;<>$"):
        for folder in folders:
            if not folder.startswith("-"):
                os.makedirs(folder, exist_ok=True)
        return 0
    print(f"the grader has no shell: `{text}` was not run")
    return -1
