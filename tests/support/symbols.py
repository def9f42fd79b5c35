"""Draw the font of the marks that pages use and many systems lack. ``python -m tests.support.symbols`` writes
it.
"""

import math
from pathlib import Path

from fontTools.fontBuilder import FontBuilder
from fontTools.pens.ttGlyphPen import TTGlyphPen

FILE = Path(__file__).parents[2] / "service" / "pages" / "static" / "symbols.woff"
EM, WIDE = 1000, 730  # font units
SCALE = WIDE / 620


def _ring(x, y, radius, *, inside=False):
    points = [
        (x + radius * math.cos(a), y + radius * math.sin(a)) for a in (math.tau * k / 32 for k in range(32))
    ]
    return points if inside else points[::-1]


# Contours, clockwise outside and anticlockwise inside, in font units.
SHAPES = {
    "✓": [[(60, 330), (140, 405), (235, 285), (475, 700), (565, 640), (250, 120)]],
    "✗": [[(85, 605), (160, 680), (310, 490), (460, 680), (535, 605), (375, 400), (535, 195), (460, 120),
    (310, 310), (160, 120),
           (85, 195), (245, 400)]],
    "⏱": [_ring(310, 350, 270), _ring(310, 350, 200, inside=True), [(275, 560), (345, 560), (345, 320), (275,
    320)],
          [(210, 740), (410, 740), (410, 670), (210, 670)]],
    "▲": [[(310, 640), (570, 160), (50, 160)]],
    "▼": [[(50, 640), (570, 640), (310, 160)]],
    "◀": [[(60, 400), (560, 680), (560, 120)]],
    "◂": [[(120, 400), (480, 600), (480, 200)]],
    "▶": [[(60, 680), (560, 400), (60, 120)]],
    "❚": [[(220, 700), (400, 700), (400, 100), (220, 100)]],
}  # fmt: skip


def _placed(point):
    """The point where the shapes, drawn 620 wide, are as large as the letters beside them."""
    x, y = point
    return round(SCALE * x), round(SCALE * (y - 400) + 370)


def font():
    """Return the font; the same for the same shapes."""
    names = {".notdef": []} | {f"uni{ord(mark):04X}": contours for mark, contours in SHAPES.items()}
    glyphs = {}
    for name, contours in names.items():
        pen = TTGlyphPen(None)
        for first, *others in contours:
            pen.moveTo(_placed(first))
            for point in others:
                pen.lineTo(_placed(point))
            pen.closePath()
        glyphs[name] = pen.glyph()
    builder = FontBuilder(EM, isTTF=True)
    builder.setupGlyphOrder(list(names))
    builder.setupCharacterMap({ord(mark): f"uni{ord(mark):04X}" for mark in SHAPES})
    builder.setupGlyf(glyphs)
    builder.setupHorizontalMetrics(dict.fromkeys(names, (WIDE, 0)))
    builder.setupHorizontalHeader(ascent=800, descent=-200)
    builder.setupNameTable({"familyName": "polhode symbols", "styleName": "Regular"})
    builder.setupOS2(sTypoAscender=800, sTypoDescender=-200, usWinAscent=800, usWinDescent=200)
    builder.setupPost()
    builder.updateHead(created=3_000_000_000, modified=3_000_000_000)  # 1999, as any other date
    builder.font.recalcTimestamp = False
    builder.font.flavor = "woff"
    return builder.font


if __name__ == "__main__":
    font().save(FILE)
