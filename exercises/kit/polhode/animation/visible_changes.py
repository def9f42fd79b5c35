"""Which artists of an animation change a pixel of its pictures,
and whether anything but text changes them.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from polhode.animation.artist_points import Drawn

Pixels = NDArray[np.uint8]
Key = tuple[int, str, int]

FAINT = 4  # of 255 levels of a colour: the eye sees no smaller difference
MOST = 64  # artists looked at in one frame; further ones count as visible


class Visibility:
    """What can be seen in ``figure``, as ``canvas`` draws it, according to the frames that ``look`` was
    called for.

    An artist is invisible if no pixel of any of these frames changes when it is hidden. In doubt it is
    visible. ``moves`` is the share of the pixels that change between these frames when no text is drawn.
    """

    def __init__(self, figure: Any, canvas: Any) -> None:
        self._figure, self._canvas = figure, canvas
        self._followed: set[Key] | None = None  # those of the first frame, as other artists have no path
        self._seen: set[Key] = set()
        self._looked_at: set[Key] = set()
        self._first: Pixels | None = None
        self._all_seen = False
        self.moves = 0.0

    @property
    def in_doubt(self) -> bool:
        """Whether nothing but text has moved so far, or the last look left an artist unseen."""
        return not (self.moves and self._all_seen)

    def look(self, drawn: list[Drawn]) -> None:
        """Look for the artists of a frame that no earlier frame showed;
        the canvas has just drawn the frame.
        """
        if self._followed is None:
            self._followed = {key for d in drawn for key in _keys(d)}
        unseen = [(d, artist) for d in drawn if self._is_unseen(d) and (artist := d.artist()) is not None][
            :MOST
        ]
        visible = self._visible([artist for _, artist in unseen], _pixels(self._canvas))
        self._all_seen = len(visible) == len(unseen)
        for d, artist in unseen:
            self._looked_at.update(_keys(d))
            if any(artist is other for other in visible):
                self._seen.update(_keys(d))
        if not self.moves:
            plain = self._without_text()
            self._first = plain if self._first is None else self._first
            same = plain.shape == self._first.shape
            self.moves = float((_words(plain) != _words(self._first)).mean()) if same else 1.0

    def split(self, paths: list[list[Drawn]]) -> tuple[list[list[Drawn]], int]:
        """Return ``paths`` without the invisible artists, and how many of the invisible ones move."""
        invisible = self._looked_at - self._seen
        kept = [[d for d in frame if not invisible.issuperset(_keys(d))] for frame in paths]
        places: dict[Key, set[bytes]] = {}
        for frame in paths:
            for d in frame:
                if invisible.issuperset(_keys(d)):
                    places.setdefault(d.key, set()).add(d.points.tobytes())
        return kept, sum(len(some) > 1 for some in places.values())

    def _is_unseen(self, d: Drawn) -> bool:
        followed = self._followed is not None and not self._followed.isdisjoint(_keys(d))
        return followed and bool(np.isfinite(d.points).any()) and self._seen.isdisjoint(_keys(d))

    def _visible(self, artists: list[Any], picture: Pixels) -> list[Any]:
        """Return which of ``artists`` change a pixel of ``picture``, the frame with all of them.

        The frame without them is drawn once, and each of them alone on top of it. A pixel that the frame
        loses belongs to the only artist that has drawn there. The search goes on among those without such a
        pixel, because others may have covered them, until there is none.
        """
        if not artists:
            return []
        with _hidden(artists):
            self._canvas.draw()
        rest = _pixels(self._canvas)
        if rest.shape != picture.shape:
            return artists
        changed = differ(picture, rest, FAINT)
        if len(artists) == 1 or not changed.any():
            return artists if changed.any() else []
        try:
            only = self._only(artists, rest)
        except Exception:  # an artist that cannot be drawn alone is not the student's mistake
            return artists
        certain = set(only[changed & (only >= 0)].tolist())
        if not certain:
            return artists
        covered = [artist for k, artist in enumerate(artists) if k not in certain]
        return [artists[k] for k in certain] + self._visible(covered, picture)

    def _only(self, artists: Sequence[Any], rest: Pixels) -> NDArray[np.int64]:
        """Return for each pixel the number of the only artist that draws there on top of ``rest``, or −1."""
        renderer = self._canvas.get_renderer()
        region = renderer.copy_from_bbox(self._figure.bbox)
        only, drawn, before = np.full(rest.shape[:2], -1), np.zeros(rest.shape[:2], dtype=int), _words(rest)
        for number, artist in enumerate(artists):
            artist.draw(renderer)
            ink = _words(_pixels(self._canvas)) != before
            drawn += ink
            only[ink] = number
            renderer.restore_region(region)
        only[drawn > 1] = -1
        return only

    def _without_text(self) -> Pixels:
        renderer = self._canvas.get_renderer()
        renderer.draw_text = renderer.draw_tex = lambda *args, **kwargs: None
        try:
            self._canvas.draw()
        finally:
            del renderer.draw_text, renderer.draw_tex
        return _pixels(self._canvas)


def differ(one: Pixels, other: Pixels, levels: int) -> NDArray[np.bool_]:
    """Return where a colour of two pictures (…, h, w, c) differs by more than ``levels`` of 255 (…, h, w)."""
    apart = np.maximum(one, other) - np.minimum(one, other) > levels
    return np.asarray(np.logical_or.reduce([apart[..., k] for k in range(apart.shape[-1])]))


def _keys(d: Drawn) -> tuple[Key, Key]:
    """Return the artist's keys in other frames, counted from the newest and from the oldest."""
    return d.key, (*d.key[:2], -d.oldest)


@contextmanager
def _hidden(artists: list[Any]) -> Iterator[None]:
    """Hide artists that are visible."""
    try:
        for artist in artists:
            artist.set_visible(False)
        yield
    finally:
        for artist in artists:
            artist.set_visible(True)


def _pixels(canvas: Any) -> Pixels:
    return np.array(canvas.buffer_rgba())


def _words(pixels: Pixels) -> NDArray[np.uint32]:
    return pixels.view(np.uint32)[:, :, 0]
