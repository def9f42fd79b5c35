"""Titles and exercise headings become plain text."""

import pytest

from exercises.authoring.importing.titles import MOST_TITLE, exercise_heading, plain


@pytest.mark.parametrize(
    ("heading", "title"),
    [
        ("The **energy** of a *chain*", "The energy of a chain"),
        ("From [Noether](noether.md) to `scipy`", "From Noether to scipy"),
        (r"Locating $T_c$ with $\beta = 1/8$", "Locating T_c with β = 1/8"),
        (r"The rate is $(I_3-I_1)/I_1\cdot\omega_3$", "The rate is (I_3-I_1)/I_1·ω_3"),
        (r"$|\mathbf{L}|$ as $t \to \infty$", "|L| as t → ∞"),
        ("Equation {eq}`eq-euler` again", "Equation eq-euler again"),
    ],
)
def test_markdown_and_latex_become_plain_text(heading, title):
    assert plain(heading) == title


def test_a_long_title_ends_at_a_word():
    title = plain("The oscillator at a temperature " * 5)
    assert len(title) <= MOST_TITLE and title.endswith("temperature…")


@pytest.mark.parametrize(
    ("heading", "number", "title"),
    [
        ("Exercise 2 — The pendulum", "2", "The pendulum"),
        ("Exercise 6 (Student) The four-way rendezvous", "6", "(Student) The four-way rendezvous"),
        ('Exercise 3: "Why" it works', "3", '"Why" it works'),
        ("Exercise 2a. $E_0$", "2a", "E_0"),
        ("4.1 Order", "4.1", "Order"),
        ("Checks", "", "Checks"),
    ],
)
def test_an_exercise_keeps_the_beginning_of_its_title(heading, number, title):
    assert exercise_heading(heading) == (number, title)
