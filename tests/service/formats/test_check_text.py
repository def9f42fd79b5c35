"""What is said of one check: harmless text, and the traceback of what kept it from being measured."""

from polhode.judging.outcome import Ended, SceneEnd
from service.formats.check_text import detail, one_line, sanitize
from tests.support.reports import TRACEBACK, example, outcome, report


def test_text_is_harmless_and_bounded():
    assert sanitize("a\r\nb\tc\x1b\u202e\ufffe\ud800\u2028") == "a\nb\tc\ufffd\ufffd\ufffd\ufffd\ufffd"
    assert one_line(" a\r\n\tb ") == "a b"
    assert sanitize("abcdef", 6) == "abcdef" and sanitize("abcdefg", 6) == "abcd …"


def test_a_check_with_everything_that_helps():
    one, _, _ = example().exercises[1].outcomes
    assert detail(one, example()).split("\n     ") == [
        "✗  euler_eqs agrees with Euler's equations   [got 2 vs expected 1]",
        "worst at ω̇₂ at question 3",
        "likely sign-flipped: ω̇₂ has the opposite sign",
        "allowed: the notebook's own tolerance",
    ]


def test_only_what_was_not_measured_has_a_traceback_and_it_is_bounded():
    long = SceneEnd("motion", Ended.RAISED, "E: x", "raises", "  x\n" * 5000 + TRACEBACK)
    unmeasured, failed = outcome("2-energy", "unmeasured", cause="E: x"), outcome("2-motion", "fail")
    told = report([unmeasured, failed], scene_ends=[long])
    assert (
        detail(unmeasured, told).endswith("ZeroDivisionError: division by zero")
        and len(detail(unmeasured, told)) < 2200
    )
    assert "Zero" not in detail(failed, told) and "Zero" not in detail(unmeasured, told, trace=False)
