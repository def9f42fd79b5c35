"""The order of the assignments on the front page."""

from datetime import UTC, datetime, timedelta
from types import SimpleNamespace

import pytest

from service.pages.course.cards import groups, next_deadline

ORDER = ["a", "b", "c", "d"]


def row(slug, days, grace_h=0.0, available=True, published=True):
    due = None if days is None else datetime.now(UTC) + timedelta(days=days)
    return SimpleNamespace(
        slug=slug, due_at=due, grace_s=3600 * grace_h, available=available, published=published
    )


def slugs(*rows, own=()):
    found = groups(rows, {one.slug: one for one in own}, ORDER)
    first = next_deadline(found, {one.slug: one for one in own})
    return {name: [one.slug for one in listed] for name, listed in found.items()}, first and first.slug


def test_open_ones_come_before_later_and_closed_ones():
    assert slugs(row("a", -3), row("b", None), row("c", 30), row("d", 2)) == (
        {"Open": ["d", "b"], "Due later": ["c"], "Closed": ["a"]},
        "d",
    )


def test_closed_ones_are_latest_first_and_open_while_in_their_grace_period():
    assert slugs(row("a", -9), row("b", -3), row("c", -0.1, grace_h=12)) == (
        {"Open": ["c"], "Closed": ["b", "a"]},
        "c",
    )


@pytest.mark.parametrize(("days", "group"), [(3, "Open"), (40, "Due later"), (-1, "Closed")])
def test_a_students_own_deadline_counts(days, group):
    found, _ = slugs(row("a", -3), own=[row("a", days)])
    assert found == {group: ["a"]}


def test_one_that_is_not_yet_available_is_neither_open_nor_the_next_one():
    assert slugs(row("a", 1, available=False), row("b", 3), row("c", -2, available=False)) == (
        {"Open": ["b"], "Not yet available": ["a"], "Closed": ["c"]},
        "b",
    )


def test_without_a_deadline_ahead_there_is_no_next_one():
    assert slugs(row("a", None), row("b", -1))[1] is None and slugs() == ({}, None)


def test_drafts_come_last_and_their_deadlines_are_not_ahead():
    rows = row("a", 1, available=False, published=False), row("b", -3)
    assert slugs(*rows) == ({"Closed": ["b"], "Drafts": ["a"]}, None)
