"""Figures are rendered one at a time, and persons take turns."""

import asyncio
from dataclasses import dataclass
from typing import Any

from service.api.figure_renderer import Renderer


@dataclass
class Stored:
    """What a renderer reads of a submission."""

    person: str
    grading: int
    assignment: str = "rigid-body"
    seed: int = 1


def test_who_wants_a_hundred_figures_does_not_delay_another(monkeypatch):
    async def main():
        renderer, drawn = Renderer(), []
        process = asyncio.Lock()

        async def call(function: Any, slug: str, name: str, *rest: Any) -> bytes:
            async with process:
                await asyncio.sleep(0.002)
                drawn.append(name)
            return name.encode()

        monkeypatch.setattr(renderer._process, "call", call)
        wanted = [renderer.figure(Stored("mallory", k), f"m{k}", b"", "png") for k in range(100)]
        twice = [renderer.figure(Stored("mallory", 0), "m0", b"", "png")]
        asked = [asyncio.ensure_future(one) for one in wanted + twice]
        await asyncio.sleep(0.005)
        before = len(drawn)
        assert await renderer.figure(Stored("alice", 1000), "a", b"", "png") == b"a"
        assert "a" in drawn[before : before + 3]
        assert await asyncio.gather(*asked) == [f"m{k}".encode() for k in range(100)] + [b"m0"]
        assert len(drawn) == 101 and not renderer._tasks and not renderer._turns

    asyncio.run(main())
