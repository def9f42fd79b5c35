"""Questions about a roster."""

from service.store.people.roster.problems import Question, count, lines, shortened


def test_a_confirmation_is_of_every_word_of_a_question():
    asked = [Question("Two?"), Question("Two?", ["ann"]), Question("Two?", ["ann", "bo"]), Question("Three?")]
    assert len({question.key for question in asked}) == 4
    assert Question("Two?", ["ann"]).key == asked[1].key


def test_numbers_in_sentences():
    assert (count(1, "line is", "lines are"), count(3, "line is", "lines are")) == (
        "1 line is",
        "3 lines are",
    )
    assert (lines([3]), lines([3, 4, 9])) == ("line 3", "lines 3, 4 and 9")
    assert shortened(["a"] * 20) == ["a"] * 20
    assert shortened(["a"] * 23) == [*["a"] * 20, "and 3 more"]
