"""Everything measured in turn, round by round, so that a machine that is busy for a while is so for all alike."""

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from bench.peers.clock import Broke, Row, Took, clock
from bench.peers.goals import ONE, SERVER
from bench.peers.peer import Command, Peer, Unread
from bench.peers.submissions import copies
from bench.peers.warm import Warm


@dataclass
class Case:
    """Something to measure, what it took so far, and why it could not be measured."""

    name: str
    what: str
    count: int
    run: Callable[[], Sequence[Took]]
    taken: list[Took] = field(default_factory=list)
    broke: str = ""


def cases(tools: Sequence[Peer], warm: Warm, batch: int, posts: int) -> list[Case]:
    """The server: one, and a batch; then each tool: one, a batch, and one that does without matplotlib."""
    found = [Case(SERVER, ONE, 1, lambda: warm.grade(posts))]
    found.append(Case(SERVER, f"{batch}: sent at once", batch, lambda: warm.at_once(batch)))
    for tool in tools:
        found += [
            Case(tool.name, ONE, 1, lambda tool=tool: graded(tool, [tool.one("right")], ["right"])),
            Case(
                tool.name, f"{batch}: {tool.batch}", batch, lambda tool=tool: graded(tool, tool.many(copies(batch)), copies(batch))
            ),
            Case(tool.name, "one without matplotlib", 1, lambda tool=tool: graded(tool, [tool.one("lean")], ["lean"])),
        ]
    return found


def graded(tool: Peer, commands: Sequence[Command], names: Sequence[str]) -> list[Took]:
    """What these commands take; raises Unread where the tool did not find these submissions right."""
    took = clock(commands, tool.place)
    clock(tool.export(), tool.place)
    if refused := [name for name in names if not tool.marks(name).full]:
        raise Unread(f"{', '.join(refused)} refused, though right")
    return [took]


def play(found: Sequence[Case], rounds: int) -> list[Row]:
    """Measure; what breaks is left out from then on and told."""
    for number in range(rounds):
        print(f"round {number + 1} of {rounds}", file=sys.stderr, flush=True)
        for case in found:
            if not case.broke:
                try:
                    case.taken += case.run()
                except (Broke, Unread) as error:
                    case.broke = str(error)
    for case in found:
        if case.broke:
            print(f"{case.name}, {case.what}: not measured: {case.broke}")
    return [Row(c.name, c.what, c.count, c.taken) for c in found if not c.broke]
