"""The encoding of a roster: known from its bytes, or guessed and asked about."""

import pytest

from service.store.people.roster.problems import BadRoster
from service.store.people.roster.text import decode

NAMES = "Änne Müller\nJosé Größ\nZoë Łoś\n"
WESTERN = NAMES.partition("Zoë")[0]


@pytest.mark.parametrize("codec", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_an_encoding_of_unicode_is_certain(codec):
    found = decode(NAMES.encode(codec), "r.csv")
    assert found.text == NAMES and not found.guessed


@pytest.mark.parametrize(
    ("codec", "encoding"), [("cp1252", "Windows-1252"), ("mac_roman", "Mac Roman"), ("cp850", "DOS 850")]
)
def test_an_encoding_of_single_bytes_is_guessed_from_the_letters_of_names(codec, encoding):
    found = decode(WESTERN.encode(codec), "r.csv")
    assert (found.text, found.encoding, found.guessed) == (WESTERN, encoding, True)


def test_an_encoding_that_is_chosen_is_not_guessed():
    found = decode("Łoś".encode("cp1250"), "r.csv", "Windows-1250")
    assert (found.text, found.guessed) == ("Łoś", False)


@pytest.mark.parametrize(
    ("content", "encoding", "why"),
    [
        (b"PK\x03\x04rest", None, "is a spreadsheet, not text: save it as CSV UTF-8"),
        (b"\xff\xfea", None, "is not text: save the roster as CSV UTF-8"),
        (b"\xff", "UTF-8", "is not text in UTF-8 .* choose another encoding"),
        (b"name", "EBCDIC", "must be one of UTF-8, UTF-16, .* not EBCDIC"),
    ],
)
def test_what_is_no_text_is_refused(content, encoding, why):
    with pytest.raises(BadRoster, match=why):
        decode(content, "r.csv", encoding)
