"""CSV that is safe to open in a spreadsheet: no text is read as a formula, and every row is one line.

A spreadsheet reads a text as a formula if it starts with = + - or @ (in any width, perhaps after invisible
characters). Where the separator is not a comma, a part of a text can become a cell. Both get an apostrophe in
front, as OWASP recommends. Numbers are written as numbers.
"""

import csv
import io
import math
import re
from collections.abc import Iterable, Sequence

Value = str | int | float | None
FORMULA = "=+\\-@" + "＝﹦⁼₌⩵⩶" + "＋﹢⁺₊﬩" + "－﹣−⁻₋" + "＠﹫"
UNSEEN = "\\s\u00ad\u061c\u180e\u200b-\u200f\u2060-\u2064\u206a-\u206f\ufeff\ufff9-\ufffb"
BYTE_ORDER_MARK = "\ufeff"
_BEGINS = re.compile(f'(^|[,;|"])([{UNSEEN}]*)(?=[{FORMULA}])')
_BREAKS = re.compile("[\t\n\v\f\r\x1c-\x1e\x85\u2028\u2029]+")
_DROPPED = re.compile(
    "[\x00-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
)  # controls; U+202A… reverse the text direction


def cell(value: Value) -> str:
    """Return the value as a CSV cell: escaped text, yes or no, a number; empty for None,
    NaN and infinities.
    """
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not isinstance(value, str):
        return repr(value)
    line = _DROPPED.sub("", _BREAKS.sub(" ", value)).strip()
    return _BEGINS.sub(r"\1'\2", line)


def table(header: Sequence[str], rows: Iterable[Sequence[Value]], *, end: str = "\r\n") -> str:
    """Return a CSV by RFC 4180, with commas and ``end`` as line ending."""
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator=end)
    writer.writerow([cell(name) for name in header])
    writer.writerows([cell(value) for value in row] for row in rows)
    return stream.getvalue()
