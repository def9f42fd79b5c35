"""No text of somebody's becomes a formula, in whatever way a spreadsheet cuts the file into cells."""

import csv
import io
import re
import sys
import unicodedata

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from service.formats.spreadsheet_csv import FORMULA, UNSEEN, cell, table

CORPUS = {
    '=HYPERLINK("http:" & A1, "x")': '\'=HYPERLINK("http:" & A1, "x")',
    "+1": "'+1",
    "-2+3": "'-2+3",
    "-ann": "'-ann",
    "@SUM(1)": "'@SUM(1)",
    "\t=1": "'=1",
    "\r=1": "'=1",
    "\n=1": "'=1",
    " =1": "'=1",
    "\u00a0=1": "'=1",
    "＝1+1": "'＝1+1",
    "﹣2": "'﹣2",
    "−2": "'−2",
    "\u200b=1": "'\u200b=1",
    "\u202e=1": "'=1",
    "\u200f=1": "'\u200f=1",
    "\x00=1": "'=1",
    "a;=1": "a;'=1",
    "a, =1": "a,' =1",
    'a",=1': "a\",'=1",
    'a"=1': "a\"'=1",
    "a|@x": "a|'@x",
    "a\n=1\r\nb": "a =1 b",
    "Ann\u200f Lee": "Ann\u200f Lee",
    "a\x00b\x1bc": "abc",
    "O'Neil-Smith, J.": "O'Neil-Smith, J.",
    "ann@uni.example": "ann@uni.example",
    "2-energy": "2-energy",
    "": "",
}


@pytest.mark.parametrize(("text", "harmless"), CORPUS.items())
def test_the_corpus(text, harmless):
    assert cell(text) == harmless


def test_numbers_stay_numbers_and_what_is_not_there_stays_empty():
    values = [-1.5, 0, 7, 1e-5, True, False, None, float("nan"), float("-inf")]
    assert [cell(value) for value in values] == ["-1.5", "0", "7", "1e-05", "yes", "no", "", "", ""]


@pytest.mark.slow
def test_every_width_of_the_four_signs_is_known():
    first = {
        chr(c): unicodedata.normalize("NFKC", chr(c))[:1]
        for c in range(sys.maxunicode + 1)
        if not 0xD800 <= c < 0xE000
    }
    missed = [
        f"U+{ord(c):04X}"
        for c, plain in first.items()
        if plain and plain in "=+-@" and not re.match(f"[{FORMULA}]", c)
    ]
    assert missed == []


TEXTS = st.lists(st.sampled_from([*CORPUS, *"=+-@＝,;|\t\n\r\"' \u200b\u202eab1"]), max_size=8).map("".join)


@given(st.one_of(st.text(max_size=20), TEXTS))
@example('";=1')
def test_however_the_file_is_cut_no_cell_begins_a_formula(text):
    told = table(["student", "points"], [[text, -1.5]])
    assert told.count("\n") == 2
    for separator in ",;|\t":
        rows = list(csv.reader(io.StringIO(told, newline=""), delimiter=separator))
        cells = [one for row in rows for one in row if not one.endswith("-1.5")]
        assert not [one for one in cells if re.match(f'["{UNSEEN}]*[{FORMULA}]', one)]


@given(st.text(max_size=20))
def test_what_is_harmless_stays_as_it_is_and_is_read_back(text):
    once = cell(text)
    assert cell(once) == once
    assert list(csv.reader(io.StringIO(table(["x", "y"], [[text, 1]]), newline="")))[1] == [once, "1"]
