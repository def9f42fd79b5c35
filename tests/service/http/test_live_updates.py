"""Pages that update themselves: one query a second for all of them, an event for each change, an end with the
server.
"""

import asyncio
import itertools
from collections import Counter
from uuid import UUID

from service.http import live_updates
from service.http.live_updates import ChangeFeed, Listener
from service.store.database import Database
from service.store.queue.runs import PROGRESS


def run_with_feed(action):
    """Run ``action`` with a feed, a source whose ``value`` the feed shows and whose ``looks`` counts queries,
    and a listener.
    """

    async def main():
        counter, source = itertools.count(1), {"looks": 0, "value": "a"}

        async def look():
            source["looks"] = next(counter)
            await asyncio.sleep(0.01)
            return source["value"]

        listener = Listener(Database("postgresql://nowhere/", "test", connections=1))
        feed = ChangeFeed(listener, look, lambda value: value)
        return await action(feed, source, listener)

    return asyncio.run(main())


async def collect(feed, into, last=None):
    async for event in feed.events(last):
        into.append((asyncio.get_running_loop().time(), event.id))


def test_one_look_at_a_time_for_forty_pages_and_each_is_told_of_each_change(monkeypatch):
    every = 0.3
    assert live_updates.EVERY_S == 1.0
    monkeypatch.setattr(live_updates, "EVERY_S", every)

    async def action(feed, source, listener):
        clock, lists = asyncio.get_running_loop().time, [[] for _ in range(40)]
        began, tasks = clock(), [asyncio.create_task(collect(feed, into)) for into in lists]
        while not all(lists):
            await asyncio.sleep(0.01)
        await asyncio.sleep(1.5 * every)
        source["value"] = "b"
        while not all(len(into) == 2 for into in lists):
            await asyncio.sleep(0.01)
        listener.leave()
        await asyncio.wait_for(asyncio.gather(*tasks), 10)  # all of them end
        return lists, source["looks"], clock() - began

    lists, looks, took = run_with_feed(action)
    assert 3 <= looks <= took / (0.9 * every) + 2
    assert all(len(into) == 2 and into[0][1] != into[1][1] for into in lists)
    assert len({tuple(id for _, id in into) for into in lists}) == 1


def test_who_comes_back_is_not_told_the_same_twice_and_a_change_of_ours_is_seen_at_once():
    async def action(feed, source, listener):
        first, again = [], []
        one = asyncio.create_task(collect(feed, first))
        await asyncio.sleep(0.2)
        two = asyncio.create_task(collect(feed, again, first[0][1]))
        await asyncio.sleep(0.2)
        source["value"] = "b"
        stale, _ = await feed.current(), feed.invalidate()
        fresh = await feed.current()
        listener.leave()
        await asyncio.gather(one, two)
        return first, again, stale, fresh

    first, again, stale, fresh = run_with_feed(action)
    assert (stale, fresh) == ("a", "b") and len(first) == 2 and [id for _, id in again] == [first[1][1]]


def test_a_look_that_began_before_a_change_is_not_kept():
    async def action(feed, source, listener):
        asked = asyncio.create_task(feed.current())
        await asyncio.sleep(0.005)
        feed.invalidate()
        await asked
        source["value"] = "b"
        return await feed.current()

    assert run_with_feed(action) == "b"


def test_a_request_for_the_result_is_not_woken_by_progress():
    async def action(feed, source, listener):
        counts = {True: 0, False: 0}

        async def wait(progress):
            async for _ in listener.wait_for_changes("s", 30.0, progress=progress):
                counts[progress] += 1

        tasks, seen = [asyncio.create_task(wait(progress)) for progress in counts], []
        for notification in ("", f"s{PROGRESS}", "s", "t", f"t{PROGRESS}"):
            listener._wake(notification)
            await asyncio.sleep(0.05)
            seen.append(tuple(counts.values()))
        listener.leave()
        await asyncio.gather(*tasks)
        return seen

    assert run_with_feed(action) == [(1, 1), (2, 1), (3, 2), (3, 2), (3, 2)]


def test_all_requests_that_wait_for_a_submission_share_one_query_for_each_of_its_changes(monkeypatch):
    monkeypatch.setattr(live_updates, "STATE_CACHED_S", 60.0)
    source, submission, others = {"value": 1}, UUID(int=1), UUID(int=2)
    asked, seen = [], Counter()

    async def state(database, id):
        asked.append(id)
        found = source["value"]
        await asyncio.sleep(0.01)
        return found

    async def action(feed, source_of_feed, listener):
        async def wait(id):
            async for _ in listener.wait_for_changes(str(id), 30.0):
                seen[await listener.state(id)] += 1

        tasks = [asyncio.create_task(wait(submission)) for _ in range(200)]
        tasks.append(asyncio.create_task(wait(others)))
        while seen[1] < 201:
            await asyncio.sleep(0.01)
        for value in (2, 3):
            source["value"] = value
            listener._wake(f"{submission}{PROGRESS}")
            while seen[value] < 200:
                await asyncio.sleep(0.01)
        before = Counter(asked)
        source["value"] = 4
        listener._wake_all()  # after notifications may have been lost
        while seen[4] < 201:
            await asyncio.sleep(0.01)
        listener.leave()
        await asyncio.gather(*tasks)
        return before, listener

    monkeypatch.setattr(live_updates.records, "state", state)
    before, listener = run_with_feed(action)
    assert before == {submission: 3, others: 1}
    assert (seen[1], seen[2], seen[3]) == (201, 200, 200)
    assert listener._states == {}, "nobody waits"
