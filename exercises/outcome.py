"""A check's answer as it stands in a report."""

from collections.abc import Collection

from pydantic import BaseModel, computed_field

from ecp.judge import Verdict, line

NEARLY = 1e-3  # a margin above this may be a matter of the tolerance


class Tolerance(BaseModel):
    """What was allowed, and why just that much. Only the numbers a check uses are set."""

    rtol: float | None = None
    atol: float | None = None
    limit: float | None = None
    reason: str


class Diagnosis(BaseModel):
    """The named likely cause of a ✗: a public code, a sentence for the student, and how sure it is (0 to 1)."""

    code: str
    sentence: str
    confidence: float


class Outcome(BaseModel):
    """One check of one attempt. ``cause`` says why nothing was measured; ``margin`` is allowed / measured.

    ``hidden``: its scenes were drawn for this attempt. ``counted`` is false where the check does not apply to what was handed in,
    such as points to follow in a drawing that has none; ``hints`` are remarks that cost nothing.
    """

    id: str
    label: str
    verdict: Verdict
    detail: str
    measured: float | None = None
    expected: float | None = None
    tolerance: Tolerance
    margin: float | None = None
    where: str | None = None
    cause: str | None = None
    diagnosis: list[Diagnosis] = []
    hints: list[str] = []
    hidden: bool = False
    counted: bool = True

    @computed_field  # type: ignore[prop-decorator]
    @property
    def line(self) -> str:
        """The ✓/✗ line, byte for byte as in the notebook."""
        return line(self.verdict, self.label, self.detail)

    def notes(self) -> list[str]:
        """Where a ✗ is worst, and how far off it is."""
        if self.verdict is not Verdict.FAIL:
            return []
        found = [f"worst at {self.where}"] if self.where else []
        if not self.margin:
            return found
        found.append(f"{1 / self.margin:.3g} times the allowed difference")
        if self.margin > NEARLY and not self.diagnosis and (would := self._would_pass()):
            found.append(f"no known slip gives these numbers: perhaps the tolerance is merely too tight; it would pass at {would}")
        return found

    def _would_pass(self) -> str | None:
        """The tolerance with which this ✗ would be a ✓."""
        tolerance, larger = self.tolerance, 1.0001 / (self.margin or 1.0)
        if tolerance.rtol:
            return f"rtol = {tolerance.rtol * larger:.2g}, atol = {(tolerance.atol or 0.0) * larger:.2g}"
        name = "limit" if tolerance.limit is not None else "atol"
        value = tolerance.limit if tolerance.limit is not None else tolerance.atol
        return f"{name} = {value * larger:.2g}" if value else None

    def text(self, told: Collection[str] = ()) -> str:
        """The line, and for anything but ✓ what helps to find the discrepancy, indented below it; not what was ``told`` already."""
        hints = [f"hint: {hint}" for hint in self.hints]
        if self.verdict is Verdict.PASS:
            return "\n".join([self.line, *(f"     {hint}" for hint in hints)])
        causes = [f"likely {d.code}: {d.sentence}" for d in self.diagnosis if d.sentence not in (self.cause, *told)]
        return "\n".join([self.line, *(f"     {note}" for note in [*self.notes(), *causes, *hints])])


class SweptPoint(BaseModel):
    """A solver at one tolerance: right-hand side calls, largest error over the run (None: it blew up), CPU seconds."""

    method: str
    rtol: float
    calls: int
    error: float | None
    seconds: float


class Swept(BaseModel):
    """Speed against accuracy of a submission: its points on ``scene`` of the reference chart, and in one line where it stands."""

    scene: str
    points: list[SweptPoint]
    line: str
