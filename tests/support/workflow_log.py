"""What a runner of GitHub Actions takes for a command in a log, by the rules of actions/runner,
ActionCommand.
"""

import re

COMMANDS = {
    "error",
    "warning",
    "notice",
    "debug",
    "group",
    "endgroup",
    "add-mask",
    "add-matcher",
    "stop-commands",
    "set-output",
    "save-state",
}
# in this order: the percent sign last
ESCAPES = {
    "%0D": "\r",
    "%0A": "\n",
    "%3A": ":",
    "%2C": ",",
    "%25": "%",
}


def commands(log):
    """The commands of a log in turn, each with properties and data; between ``stop-commands`` and its token
    there are none.
    """
    found, registered, token = [], set(COMMANDS), None
    for line in re.split(r"\r\n|\r|\n", log):
        command = _second(line, registered) or _first(line, registered)
        if command is None:
            continue
        if token is not None:
            token = None if command[0] == token else token
        elif command[0] == "stop-commands":
            token = command[2]
            registered.add(token)
        else:
            found.append(command)
    return found


def _second(line, registered):
    """A line that begins with :: after blanks."""
    name, two, data = line.lstrip().removeprefix("::").partition("::")
    if not line.lstrip().startswith("::") or not two:
        return None
    command, _, properties = name.partition(" ")
    if command not in registered:
        return None
    pairs = [pair.split("=", 1) for pair in properties.strip().split(",") if "=" in pair]
    return command, {key: _unescaped(value) for key, value in pairs}, _unescaped(data, "%0D", "%0A", "%25")


def _first(line, registered):
    """A line that holds ##[ somewhere: an older form that runners still take."""
    match = re.search(r"##\[([^\] ]*)([^\]]*)\](.*)", line, re.DOTALL)
    return (match[1], {}, match[3]) if match and match[1] in registered else None


def _unescaped(value, *which):
    for escape in which or ESCAPES:
        value = value.replace(escape, ESCAPES[escape])
    return value
