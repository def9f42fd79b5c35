"""What each tool says about right and wrong answers, and whether there is anything to compare."""

from collections.abc import Mapping, Sequence

from bench.peers.clock import Broke, clock
from bench.peers.peer import Marks, Peer, Unread
from bench.peers.submissions import SAMPLES, Submission, file_name

Given = Mapping[str, Marks | str]


def verdicts(tools: Sequence[Peer], sent: Mapping[str, Submission]) -> dict[str, Given]:
    """By tool and by kind: marks, or "no answer"; what went wrong is printed. This also warms the disk's cache."""
    given: dict[str, Given] = {}
    for tool in tools:
        try:
            clock(tool.prepare(sent), tool.place)
            given[tool.name] = _judged(tool)
        except Broke as error:
            print(f"{tool.name}: {error}")
            given[tool.name] = dict.fromkeys(SAMPLES, "no answer")
    return given


def answers(given: Given) -> bool:
    """Whether a tool says anything about what is right and about a slipped sign."""
    return isinstance(given["right"], Marks) and isinstance(given["sign slip"], Marks)


def sound(given: Given) -> bool:
    """Whether a tool accepts what is right and does not accept a slipped sign."""
    right, slip = given["right"], given["sign slip"]
    return isinstance(right, Marks) and right.full and isinstance(slip, Marks) and not slip.full


def _judged(tool: Peer) -> Given:
    for kind in SAMPLES:
        try:
            clock([tool.one(file_name(kind))], tool.place, codes=())
        except Broke as error:
            print(f"{tool.name}, {kind}: {error}")
    clock(tool.export(), tool.place)
    return {kind: _marks(tool, kind) for kind in SAMPLES}


def _marks(tool: Peer, kind: str) -> Marks | str:
    try:
        return tool.marks(file_name(kind))
    except Unread as error:
        print(f"{tool.name}, {kind}: {error}")
        return "no answer"
