"""What a template shows of a stranger's text: escaped, and nothing in it that turns the text beside it."""

import re
from datetime import UTC, datetime, timedelta

import pytest
from markupsafe import Markup

from service.http.templating import ENVIRONMENT, format_relative, format_span
from service.sandbox.untrusted_text import BIDI_CONTROLS


def shown(template, **values):
    return ENVIRONMENT.from_string("{% autoescape true %}" + template + "{% endautoescape %}").render(values)


@pytest.mark.parametrize("control", BIDI_CONTROLS)
def test_nothing_turns_what_stands_beside_it(control):
    value = f"<b>{control}x"
    assert shown("{{ v }}", v=value) == "&lt;b&gt;\ufffdx"
    assert shown('<a title="{{ v | truncate(9) }}">', v=value) == '<a title="&lt;b&gt;\ufffdx">'
    assert shown("{{ v }}", v=Markup("<i>{}</i>").format(value)) == "<i>&lt;b&gt;\ufffdx</i>", (
        "also in markup made elsewhere"
    )
    assert shown("{{ v }}", v=[value]).count("&lt;b&gt;") == 1 and control not in shown("{{ v }}", v=[value])
    assert (
        shown("{% macro m(w) %}<p>{{ w }}</p>{% endmacro %}{{ m(v) }}", v=value) == "<p>&lt;b&gt;\ufffdx</p>"
    )


def test_templates_escape_without_saying_so():
    assert ENVIRONMENT.from_string("{{ v }}").render(v="<b>") == "&lt;b&gt;"
    for name in ENVIRONMENT.list_templates():
        source = ENVIRONMENT.loader.get_source(ENVIRONMENT, name)[0]
        trusted = re.findall(r"[^{ ]+(?: [^{ ]+)? ?\|\s*safe\b", source)
        assert "autoescape" not in source and set(trusted) <= {"""' aria-current="true"' | safe"""}, name


def test_all_else_is_as_it_was():
    assert (
        shown("{{ a }} {{ b }} {{ c }} {{ d }}", a=1.5, b=None, c="שרה ŷ\u0307 ⏱", d=Markup("<i>"))
        == "1.5 None שרה ŷ\u0307 ⏱ <i>"
    )
    assert shown("{{ missing }}|") == "|"


def test_a_grace_period_is_named_in_its_longest_whole_unit():
    spans = {
        900: "15 min",
        5400: "90 min",
        3600: "1 h",
        129600: "36 h",
        86400: "1 day",
        864000: "10 days",
        90: "1.5 min",
        0: "0 min",
    }
    assert {seconds: format_span(seconds) for seconds in spans} == spans


@pytest.mark.parametrize(
    ("away", "words"),
    [
        (timedelta(seconds=20), "now"),
        (timedelta(minutes=45, seconds=5), "in 45 min"),
        (timedelta(hours=30, seconds=5), "in 30 h"),
        (timedelta(days=2, hours=5), "in 2 days"),
        (-timedelta(days=3, seconds=5), "3 days ago"),
        (-timedelta(hours=2, seconds=5), "2 h ago"),
    ],
)
def test_a_time_is_said_as_seen_from_now_and_exactly_on_hover(away, words):
    at = datetime.now(UTC) + away
    told = format_relative(at)
    assert told.endswith(f">{words}</time>") and f'title="{at:%Y-%m-%d %H:%M} UTC"' in told


def test_a_far_time_is_a_date_with_its_year_if_that_is_another():
    soon, far = (datetime.now(UTC) + timedelta(days=days) for days in (30, 400))
    assert f">on {soon.day} {soon:%B}</time>" in format_relative(soon)
    assert (
        f">on {far.day} {far:%B} {far.year}</time>" in format_relative(far) and format_relative(None) == "–"
    )
