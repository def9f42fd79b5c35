"""What is counted of failed logins, and for how long."""

import time
from contextlib import ExitStack

import pytest
from fastapi import Request

from service.auth import passwords
from service.auth.rate_limit import BY_ADDRESS, BY_NAME, LoginRateLimiter
from service.http.errors import Problem
from service.http.requests import network

ANN, BEN, HERE = (BY_NAME, "name", "ann"), (BY_NAME, "name", "ben"), (BY_ADDRESS, "address", "10.0.0.1")


def fail(limiter, *keys, status=401):
    with pytest.raises(Problem) as told, limiter.guard(*keys):
        raise Problem(status, "nobody", "wrong")
    return told.value


def test_an_address_may_fail_at_many_names_but_not_at_all_of_them():
    limiter = LoginRateLimiter()
    assert {fail(limiter, (BY_NAME, "name", str(n)), HERE).status for n in range(100)} == {401}
    refused = fail(limiter, ANN, HERE)
    assert refused.status == 429 and 590 < refused.retry_after <= 600
    assert fail(limiter, ANN, (BY_ADDRESS, "address", "10.0.0.2")).status == 401


def test_only_what_was_wrong_counts_and_a_refusal_does_not():
    limiter = LoginRateLimiter()
    for _ in range(20):
        fail(limiter, ANN, status=503)
        with limiter.guard(ANN):
            pass
    assert [fail(limiter, ANN).status for _ in range(30)] == [401] * 10 + [429] * 20
    with limiter.guard(BEN):
        pass


def test_many_guesses_at_once_are_no_more_than_one_after_the_other():
    limiter = LoginRateLimiter()
    with ExitStack() as stack:
        for _ in range(10):
            stack.enter_context(limiter.guard(ANN))
        refused = fail(limiter, ANN)
        assert (refused.status, refused.retry_after) == (429, 1)
    with limiter.guard(ANN):
        pass
    assert not limiter._pending


@pytest.mark.parametrize("hours", [1, -1])
def test_a_clock_that_jumps_locks_nobody_out_for_an_hour(monkeypatch, hours):
    limiter, clock = LoginRateLimiter(), time.time
    assert [fail(limiter, ANN).status for _ in range(11)] == [401] * 10 + [429]
    monkeypatch.setattr(time, "time", lambda: clock() + 3600 * hours)
    assert [fail(limiter, ANN).status for _ in range(11)] == [401] * 10 + [429]
    refused = fail(limiter, ANN)
    assert refused.status == 429 and refused.retry_after <= 15 * 60


def test_guesses_from_one_address_at_once_leave_others_a_place_to_log_in():
    limiter, begun = LoginRateLimiter(), 0
    with ExitStack() as stack:
        for n in range(150):
            try:
                stack.enter_context(limiter.guard((BY_NAME, "name", str(n)), HERE))
                begun += 1
            except Problem as refused:
                assert (refused.status, refused.retry_after) == (429, 1)
        assert 0 < begun <= passwords.MOST_WAITING / 2
        stack.enter_context(limiter.guard(ANN, (BY_ADDRESS, "address", "10.0.0.2")))


@pytest.mark.parametrize(
    ("address", "whose"),
    [
        ("10.1.2.3", "10.1.2.3"),
        ("2001:db8:1:2:3:4:5:6", "2001:db8:1:2::/64"),
        ("::ffff:10.1.2.3", "10.1.2.3"),
        ("testclient", "unknown"),
    ],
)
def test_a_customer_of_a_network_is_one_address(address, whose):
    assert network(address) == whose


def test_a_class_behind_one_address_starts_its_logins_and_another_address_is_not_affected_by_more():
    limiter = LoginRateLimiter()

    def start(address):
        limiter.start(Request({"type": "http", "headers": [], "client": (address, 1)}))

    for _ in range(300):
        start("10.0.0.1")
    for _ in range(2):
        with pytest.raises(Problem) as refused:
            start("10.0.0.1")
        assert refused.value.status == 429 and 50 < refused.value.retry_after <= 60
    start("10.0.0.2")
