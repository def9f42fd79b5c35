"""Names that a reader of the folder could take for an option, a command, a pattern, markup, or the end of a line."""

# ends: pass
import os

odd = [
    b"\n",
    b"a\nb",
    b"-rf",
    b"--",
    b"*",
    b"~",
    b"$(left)",
    b"`left`",
    b"<script>alert(1)",
    b"\x1b[2J",
    b"con.json",
]
odd += [
    b"\xff\xfe",
    b"\x80" * 255,
    b"x" * 255,
    b" ",
    b"...",
    b"\\",
    b"%s%n",
    "\u202egnp.exe".encode(),
    "é".encode(),
    b"'\"",
]
for name in odd:
    os.mkdir(name)
    for inner in odd:
        open(name + b"/" + inner, "wb").close()
for name in (b"x" * 256, b"a/../../left", b"", b"../left", b"\0left"):
    attempt(repr(name), lambda: open(name, "wb"))
