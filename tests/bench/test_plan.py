"""The simulated queue against waits computed by hand, against queueing theory, and as it is printed."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bench import plan
from bench.plan import (
    QUANTILES,
    Arrivals,
    Deadline,
    draw,
    main,
    measured,
    simulate,
    start_times,
    summary,
    table,
    workers_needed,
)


def arrivals(accepted, person, service):
    person = np.asarray(person)
    turn = (
        np.array([np.count_nonzero(person[: k + 1] == who) for k, who in enumerate(person)])
        if len(person) < 1000
        else person * 0 + 1
    )
    return Arrivals(
        np.asarray(accepted, float), person, turn, np.broadcast_to(np.asarray(service, float), len(person))
    )


def poisson(n, rate, service, seed):
    """Everybody sends once, at exponential intervals."""
    return arrivals(np.cumsum(np.random.default_rng(seed).exponential(1 / rate, n)), np.arange(n), service)


def mean_wait(given, workers):
    return float(np.mean(start_times(given, workers) - given.accepted))


def test_one_worker_by_hand():
    given = arrivals([0, 1, 2, 20], [1, 2, 3, 4], [5, 3, 2, 1])
    assert start_times(given, 1).tolist() == [0, 5, 8, 20]
    found = summary(given, start_times(given, 1), 1, deadline_s=4)
    # of 0, 0, 4 and 6
    assert found.waits["all"] == pytest.approx({"p50": 2.0, "p90": 5.4, "p99": 5.94, "max": 6.0})
    assert (found.longest_queue, found.emptied_s) == (2, 16)
    assert found.utilisation == 11 / 21


def test_two_workers_by_hand():
    assert start_times(arrivals([0, 1, 2, 3], [1, 2, 3, 4], [5, 3, 2, 1]), 2).tolist() == [0, 1, 4, 5]


def test_who_sends_ten_at_once_lets_another_pass():
    given = arrivals([0] * 10 + [0.1], ["greedy"] * 10 + ["modest"], 1)
    begun = start_times(given, 1)
    assert begun.tolist() == [0, *range(2, 11), 1]


def test_what_is_being_graded_counts_too():
    assert start_times(arrivals([0, 0.5, 1.5, 1.6], ["a", "a", "b", "a"], 1), 1).tolist() == [0, 1, 2, 3]


def test_who_sent_again_waits_for_nobody_who_comes_after_the_first_result():
    given = arrivals([0, 0.1, 0.2, 0.9, 1.9, 2.9], ["a", "a", "b", "c", "d", "e"], 1)
    assert start_times(given, 1).tolist() == [0, 3, 1, 2, 4, 5]


def test_persons_take_turns():
    """The same order as in the test of that name in tests/service/store/queue/test_runs.py."""
    given = arrivals([0] * 8 + [3.5], ["ann"] * 5 + ["ben"] * 2 + ["cleo", "dora"], 1)
    order = given.person[np.argsort(start_times(given, 1))].tolist()
    assert order == ["ann", "ben", "cleo", "ann", "ben", "dora", "ann", "ann", "ann"]


def test_a_result_moves_the_next_up_though_an_earlier_one_is_still_being_graded():
    given = arrivals([0, 0.1, 0.2, 0.3, 0.4, 0.5], ["a", "b", "a", "b", "b", "a"], [10, 10, 1, 1, 1, 1])
    # a's third passes b's third, not b's second
    assert start_times(given, 3).tolist() == pytest.approx([0, 0.1, 0.2, 1.2, 3.2, 2.2])


def oldest(given, begun):
    """Since when each was its person's oldest without result."""
    since, done = given.accepted.copy(), begun + given.service
    for k, who in enumerate(given.person):
        since[k] = max([since[k], *done[:k][given.person[:k] == who]])
    return since


@pytest.mark.parametrize("rush", [False, True])
def test_nobody_starves(rush):
    """Whoever's turn it is waits for each of the others at most once,
    and for nobody whose turn comes later.
    """
    asked = Deadline(students=300, minutes=2, workers=2, rush=rush, seconds=(0.36,))
    given = draw(asked)
    begun = start_times(given, 2)
    since = oldest(given, begun)
    assert np.max(begun - since) <= 300 * 0.36 / 2
    for k in range(0, 900, 30):
        early = np.count_nonzero(given.accepted <= since[k])
        without = Arrivals(*(a[:early] for a in (given.accepted, given.person, given.turn, given.service)))
        assert start_times(without, 2)[k] == begun[k]
    top = since <= begun
    by_turn = np.argsort(since[top], kind="stable")
    assert np.all(np.diff(begun[top][by_turn]) >= 0)


def test_waits_at_a_deadline_that_two_workers_cannot_meet():
    waits = simulate(Deadline(students=300, minutes=2, workers=2, seconds=(0.36,))).waits
    found = [
        [waits[which][q] for q in ("p50", "p99", "max")]
        for which in ("students' first", "students' no. 3", "all")
    ]
    # where nobody ever moved up, all waited 10.2, 101.6 and 124.2; first come, first served: 17.7, 41.2 and
    # 42.0
    assert found == [
        pytest.approx(row, abs=0.1) for row in ([6.4, 22.3, 32.8], [31.3, 63.3, 72.2], [16.6, 56.1, 72.2])
    ]


def test_the_wait_begins_anew_once_there_is_a_result():
    assert start_times(arrivals([0, 0, 2, 2], ["a", "b", "b", "a"], 1), 1).tolist() == [0, 1, 2, 3]


def test_nobody_waits_where_everybody_has_a_worker():
    found = simulate(Deadline(students=20, minutes=1, workers=60, seconds=(30.0,)))
    assert found.waits["all"] == dict.fromkeys(QUANTILES, 0.0)
    assert (found.longest_queue, found.emptied_s) == (0, 0)


def test_no_order_changes_when_workers_begin():
    """With one constant service time the moments at which work is begun are the same in any order of a
    queue.
    """
    given = draw(Deadline(students=40, minutes=1, workers=3, submissions=5, rush=True, seconds=(1.0,)))
    in_turn = Arrivals(given.accepted, np.arange(len(given.person)), given.turn, given.service)
    ranked, first_come = start_times(given, 3), start_times(in_turn, 3)
    assert not np.array_equal(ranked, first_come)
    np.testing.assert_array_equal(np.sort(ranked), first_come)


@pytest.mark.parametrize(("workers", "load"), [pytest.param(1, 0.6, marks=pytest.mark.slow), (4, 0.7)])
def test_mean_wait_is_erlangs(workers, load):
    """M/M/c: Erlang's C formula."""
    n, offered = 200_000, workers * load
    given = poisson(n, offered, np.random.default_rng(2).exponential(1.0, n), seed=1)
    tail = offered**workers / math.factorial(workers) / (1 - load)
    waiting = tail / (sum(offered**k / math.factorial(k) for k in range(workers)) + tail)
    assert mean_wait(given, workers) == pytest.approx(waiting / (workers - offered), rel=0.03)


@pytest.mark.slow
def test_mean_wait_is_that_of_pollaczek_and_khinchine():
    """M/D/1: half of M/M/1."""
    assert mean_wait(poisson(200_000, 0.6, 1.0, seed=3), 1) == pytest.approx(0.6 / (2 * (1 - 0.6)), rel=0.03)


@pytest.mark.parametrize(("rush", "moments"), [(False, (1 / 2, 1 / 3)), (True, (2 / 3, 1 / 2))])
def test_arrivals_are_distributed_as_told(rush, moments):
    given = draw(Deadline(students=20_000, minutes=1, workers=1, rush=rush, seconds=(1.0, 3.0)))
    at = given.accepted / 60
    assert (np.mean(at), np.mean(at**2)) == pytest.approx(moments, abs=0.01)
    assert np.all(np.diff(at) >= 0)
    assert np.mean(given.service) == pytest.approx(2.0, abs=0.02)
    assert np.bincount(given.person).tolist() == [3] * 20_000
    mine = given.person == 7
    assert given.turn[mine].tolist() == [1, 2, 3]


def test_the_same_seed_gives_the_same_answer():
    one, same, other = (
        simulate(Deadline(students=50, minutes=2, workers=1, seed=seed)) for seed in (1, 1, 2)
    )
    assert one == same
    assert one != other


def test_first_submissions_wait_less_in_a_rush():
    found = simulate(Deadline(students=300, minutes=2, workers=2, rush=True, seconds=(0.3, 0.6)))
    assert found.waits["students' first"]["p90"] < found.waits["students' no. 3"]["p90"]


def test_fewer_seconds_need_more_workers_and_one_less_is_too_few():
    asked = Deadline(students=100, minutes=1, workers=1, seconds=(0.5, 2.0))
    limits = (0.0, 1.0, 5.0, 30.0, 1e6)
    needed = [workers_needed(asked, limit) for limit in limits]
    assert needed == sorted(needed, reverse=True)
    assert needed[0] > needed[-1] == 1
    arrived = draw(asked)
    for limit, workers in zip(limits[:-1], needed, strict=False):
        waits = [
            np.quantile(start_times(arrived, w) - arrived.accepted, 0.99) for w in (workers - 1, workers)
        ]
        assert waits[0] > limit >= waits[1]


def test_what_is_out_of_range_is_named_together():
    with pytest.raises(ValueError, match=r"^--students and --minutes must be more than 0$"):
        Deadline(students=0, minutes=math.nan, workers=1)
    with pytest.raises(ValueError, match="must not be negative"):
        workers_needed(Deadline(students=1, minutes=1, workers=1), -1.0)


def test_table():
    given = arrivals([0, 1, 2, 20], ["a", "a", "b", "c"], [5, 3, 2, 1])
    assert (
        table(summary(given, start_times(given, 1), 1, deadline_s=4))
        == "seconds waited            p50      p90      p99      max\n"
        "all                       1.5      5.1      5.9      6.0\n"
        "students' first           0.0      2.4      2.9      3.0\n"
        "students' no. 2           6.0      6.0      6.0      6.0\n"
        "longest queue 2, workers 52% busy\n"
        "queue empty 16 s after the deadline"
    )


def run(line):
    return main(line.split())


def test_command(capsys):
    assert run("--students 30 --minutes 1 --workers 2 --rush --p99 0") == 0
    told = capsys.readouterr().out
    assert told.count("seconds waited") == 2
    assert "keep the p99 wait at or below 0 s" in told
    assert run("--students 30 --minutes 1") == 2
    assert run("--students 30 --minutes 1 --workers 0") == 2
    assert "--workers must be more than 0" in capsys.readouterr().err


def test_the_chart_has_the_fewest_workers_and_what_they_cost_at_each_class_size(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(plan, "CLASSES", (10, 300))
    asked = Deadline(students=1, minutes=1, workers=1, seconds=(0.5, 2.0))
    found = plan.costs(asked, 5.0)
    for students, workers, cost in found:
        assert workers == workers_needed(replace(asked, students=students), 5.0)
        waits = simulate(replace(asked, students=students, workers=workers))
        assert cost * students * asked.submissions == pytest.approx(workers * (60 + waits.emptied_s))
    assert found[0][2] > found[1][2] > 1.25, (
        "few students leave a worker idle; no worker is cheaper than the grading"
    )
    file = tmp_path / "cost.svg"
    assert run(f"--chart {file} --minutes 1 --p99 60 --submissions 2") == 0
    drawn = file.read_text()
    assert "one exercise:" in drawn and "a whole notebook:" in drawn
    assert "2 submissions each in 1 min; 99 % wait at most 60 s" in drawn
    for more in ("", "--p99 1 --workers 2", "--p99 1 --notebook"):
        assert (
            run(f"--chart {file} --minutes 1 {more}") == 2
            and "give --p99, not --workers" in capsys.readouterr().err
        )


def test_whole_notebooks_take_longer_than_one_exercise(capsys):
    asked = ["--students", "100", "--minutes", "1", "--workers", "1"]
    printed = []
    for more in ([], ["--notebook"]):
        assert main([*asked, *more]) == 0
        printed.append(capsys.readouterr().out)
    assert printed[0] != printed[1]
    assert sum(measured("notebook")) / len(measured("notebook")) > sum(measured("exercise")) / len(
        measured("exercise")
    )
