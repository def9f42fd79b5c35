"""The verdicts of each tool on correct and wrong submissions, and whether the tool can be compared."""

from collections.abc import Mapping, Sequence

from bench.peers.clock import CommandFailed, clock
from bench.peers.peer import Marks, NoMarks, Peer
from bench.peers.submissions import SAMPLES, Submission, file_name

Given = Mapping[str, Marks | str]


def verdicts(tools: Sequence[Peer], sent: Mapping[str, Submission]) -> dict[str, Given]:
    """Return marks or "no answer" by tool and kind of submission, and print errors. This also warms the disk
    cache.
    """
    given: dict[str, Given] = {}
    for tool in tools:
        try:
            clock(tool.prepare(sent), tool.workspace)
            given[tool.name] = _all_marks(tool)
        except CommandFailed as error:
            print(f"{tool.name}: {error}")
            given[tool.name] = dict.fromkeys(SAMPLES, "no answer")
    return given


def answers(given: Given) -> bool:
    """Return whether a tool gives marks to the correct submission and to the sign error."""
    return isinstance(given["right"], Marks) and isinstance(given["sign slip"], Marks)


def sound(given: Given) -> bool:
    """Return whether a tool accepts the correct submission and rejects the sign error."""
    right, slip = given["right"], given["sign slip"]
    return isinstance(right, Marks) and right.full and isinstance(slip, Marks) and not slip.full


def _all_marks(tool: Peer) -> Given:
    for kind in SAMPLES:
        try:
            clock([tool.one(file_name(kind))], tool.workspace, codes=())
        except CommandFailed as error:
            print(f"{tool.name}, {kind}: {error}")
    clock(tool.export(), tool.workspace)
    return {kind: _marks(tool, kind) for kind in SAMPLES}


def _marks(tool: Peer, kind: str) -> Marks | str:
    try:
        return tool.marks(file_name(kind))
    except NoMarks as error:
        print(f"{tool.name}, {kind}: {error}")
        return "no answer"
