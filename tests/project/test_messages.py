"""docs/messages.md lists every message that the source can show, so that a new one is reviewed; and all are
plain English.
"""

import re

from tests.support.messages import FILE, document, messages

PRIVATE = r"\b(told|tells?|telling|anew|walls?|somebody|whoever|specimens?|tier [AB]|heard of|goes away)\b"
SOURCE = '''
HELP = "a constant that reads as prose"
QUERY = "SELECT id FROM grading WHERE id = :id"

def run(parser, n):
    """This docstring is no message."""
    parser.add_argument("--jobs", help=f"grade at most {n} files", metavar="N")
    if n < 0:
        raise ValueError(f"expected at least 1 file, got {n}" if n else "no file given")
    print(f"polhode: {n} files", "could not be read")
    raise Problem(404, "not-found", "there is no " + f"submission {n}")

def remarks(found, names, late):
    found.append("" if late else "The server graded another text.")
    yield from (f"{name}: the file does not exist" for name in names)
    yield "Late."

HEADER = "default-src 'none'; style-src 'unsafe-inline'; img-src data:"
STYLE = "p{color:red; margin:0 of the page}"
'''
PAGE = """<h1>Audit log</h1>{% if rows %}<p>{{ rows | length }} entries</p>{% else %}<p>No entries.</p>{% endif %}
<nav aria-label="Pages of the log"></nav>{{ "by a student" if me else "by nobody" }}"""


def test_the_list_is_that_of_the_source():
    assert FILE.read_text() == document(), (
        "run: python -m tests.support.messages, then review the difference of docs/messages.md"
    )


def test_messages_of_code_are_found_with_values_left_out(tmp_path):
    (tmp_path / "a.py").write_text(SOURCE)
    assert messages(tmp_path / "a.py") == [
        "a constant that reads as prose",
        "grade at most … files",
        "expected at least 1 file, got …",
        "no file given",
        "polhode: … files",
        "could not be read",
        "there is no",
        "The server graded another text.",
        "…: the file does not exist",
        "Late.",
    ]


def test_messages_of_a_page_are_its_visible_text_and_its_labels(tmp_path):
    (tmp_path / "a.html").write_text(PAGE)
    assert messages(tmp_path / "a.html") == [
        "Audit log", "… entries", "No entries.", "(aria-label) Pages of the log", "by a student", "by nobody",
    ]  # fmt: skip


def test_no_message_uses_a_private_word():
    found = [line for line in FILE.read_text().splitlines() if re.search(PRIVATE, line, re.IGNORECASE)]
    assert found == []
