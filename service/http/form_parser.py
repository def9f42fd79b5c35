"""The forms of a page: where their elements are in its text."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from html.parser import HTMLParser

from markupsafe import Markup

ENCLOSING = ("form", "details", "label", "select", "textarea", "option")
CONTROLS = ("input", "select", "textarea", "button")


@dataclass(eq=False)
class Element:
    """An element of a page: where its start tag begins and stops, where its content and its end tag stop, and
    what encloses it.

    Without an end tag all of these stop with the start tag. ``controls`` are those of a form.
    """

    tag: str
    attributes: dict[str, str | None]
    start: int
    start_stop: int
    content_stop: int
    stop: int
    around: tuple["Element", ...]
    controls: list["Element"] = field(default_factory=list)

    @property
    def name(self) -> str:
        """Return the name of a control, "" without one."""
        return self.attributes.get("name") or ""

    @property
    def kind(self) -> str:
        """Return the type of an input, the tag of any other element."""
        return (self.attributes.get("type") or "text") if self.tag == "input" else self.tag

    def start_tag(self, changes: Mapping[str, str | None]) -> str:
        """Return the start tag with other attributes; None leaves one out."""
        kept = {name: value or "" for name, value in self.attributes.items() if name not in changes}
        kept |= {name: value for name, value in changes.items() if value is not None}
        return f"<{self.tag}" + "".join(Markup(' {}="{}"').format(*pair) for pair in kept.items()) + ">"


class FormParser(HTMLParser):
    """Finds the ``forms`` of a page with their controls, and the ``options`` of lists."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self._lines = [0, *(k + 1 for k, character in enumerate(page) if character == "\n")]
        self._open: list[Element] = []
        self.forms: list[Element] = []
        self.options: list[Element] = []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note the element."""
        if tag == "option" and self._open and self._open[-1].tag == "option":
            self._open.pop()  # the end tag of an option may be missing
        start = self._at()
        stop = start + len(self.get_starttag_text() or "")
        element = Element(tag, dict(attrs), start, stop, stop, stop, tuple(self._open))
        form = next((one for one in self._open if one.tag == "form"), None)
        if tag in ENCLOSING:
            self._open.append(element)
        if tag == "form":
            self.forms.append(element)
        elif tag == "option":
            self.options.append(element)
        elif tag in CONTROLS and form is not None:
            form.controls.append(element)

    def handle_endtag(self, tag: str) -> None:
        """Note where the element ends."""
        if any(one.tag == tag for one in self._open):
            while (element := self._open.pop()).tag != tag:
                pass
            element.content_stop = self._at()
            element.stop = element.content_stop + len(f"</{tag}>")

    def _at(self) -> int:
        line, column = self.getpos()
        return self._lines[line - 1] + column
