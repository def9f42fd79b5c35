"""All measurements, interleaved in rounds, so that a temporarily busy machine affects all tools alike."""

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from bench.forms import FORMS
from bench.peers.clock import CommandFailed, Row, Timing, clock
from bench.peers.goals import ONE, SERVER, WHOLE
from bench.peers.peer import Command, NoMarks, Peer
from bench.peers.submissions import copies
from bench.peers.warm import Warm


@dataclass
class Case:
    """One thing to measure, its times so far, and why it could not be measured."""

    name: str
    what: str
    count: int
    run: Callable[[], Sequence[Timing]]
    taken: list[Timing] = field(default_factory=list)
    error: str = ""


def cases(tools: Sequence[Peer], warm: Warm, batch: int) -> list[Case]:
    """Return the cases: each of the fifteen FORMS and a batch of them, for the server and each tool, and a
    whole notebook for the server.
    """
    found = [Case(SERVER, ONE, 1, warm.grade_forms), Case(SERVER, WHOLE, 1, warm.grade_notebook)]
    found.append(Case(SERVER, f"{batch}: sent at once", batch, lambda: warm.grade_together(batch)))
    for tool in tools:
        found += [
            Case(tool.name, ONE, 1, lambda tool=tool: one_by_one(tool, FORMS)),
            Case(
                tool.name,
                f"{batch}: {tool.batch}",
                batch,
                lambda tool=tool: graded(tool, tool.many(copies(batch)), copies(batch)),
            ),
        ]
    return found


def one_by_one(tool: Peer, names: Sequence[str]) -> list[Timing]:
    """Return the time of each submission on its own, as ``graded`` does."""
    return [taken for name in names for taken in graded(tool, [tool.one(name)], [name])]


def graded(tool: Peer, commands: Sequence[Command], names: Sequence[str]) -> list[Timing]:
    """Return the time of the commands. Raises NoMarks if the tool did not accept these submissions, which are
    correct.
    """
    took = clock(commands, tool.workspace)
    clock(tool.export(), tool.workspace)
    if refused := [name for name in names if not tool.marks(name).full]:
        raise NoMarks(f"{', '.join(refused)} rejected, though correct")
    return [took]


def measure(found: Sequence[Case], rounds: int) -> list[Row]:
    """Measure all cases. A case that fails is reported and left out from then on."""
    for number in range(rounds):
        print(f"round {number + 1} of {rounds}", file=sys.stderr, flush=True)
        for case in found:
            if not case.error:
                try:
                    case.taken += case.run()
                except (CommandFailed, NoMarks) as failure:
                    case.error = str(failure)
    for case in found:
        if case.error:
            print(f"{case.name}, {case.what}: not measured: {case.error}")
    return [Row(c.name, c.what, c.count, c.taken) for c in found if not c.error]
