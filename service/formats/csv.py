"""CSV that a spreadsheet may open: no text in it is taken for a formula, and every row is one line.

A text is a formula to a spreadsheet if it begins with = + - or @, in any of their widths, perhaps after characters that do not
show; and a part of a text can become a cell of its own where another separator than the comma is usual. So an apostrophe is put
before these, as OWASP advises. Numbers are written as numbers.
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
_DROPPED = re.compile("[\x00-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")  # the marks among them turn whole lines around


def cell(value: Value) -> str:
    """The value as it stands in a CSV: a text made harmless, yes or no, a number, nothing for None and what is not finite."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return _harmless(value) if isinstance(value, str) else repr(value)


def table(header: Sequence[str], rows: Iterable[Sequence[Value]], *, end: str = "\r\n") -> str:
    """A CSV as RFC 4180 has it, with commas."""
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator=end)
    writer.writerow([cell(name) for name in header])
    writer.writerows([cell(value) for value in row] for row in rows)
    return stream.getvalue()


def _harmless(text: str) -> str:
    line = _DROPPED.sub("", _BREAKS.sub(" ", text)).strip()
    return _BEGINS.sub(r"\1'\2", line)
