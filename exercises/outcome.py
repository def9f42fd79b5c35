"""A check's answer as it stands in a report."""

from collections.abc import Collection

from pydantic import BaseModel, computed_field

from ecp.judge import Verdict, line


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
    """One check of one attempt. ``cause`` says why nothing was measured; ``margin`` is allowed / measured."""

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
    hidden: bool = False

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
        return [*found, f"{1 / self.margin:.3g} times the allowed difference"] if self.margin else found

    def text(self, told: Collection[str] = ()) -> str:
        """The line, and for anything but ✓ what helps to find the discrepancy, indented below it; not what was ``told`` already."""
        if self.verdict is Verdict.PASS:
            return self.line
        causes = [f"likely {d.code}: {d.sentence}" for d in self.diagnosis if d.sentence not in (self.cause, *told)]
        return "\n".join([self.line, *(f"     {note}" for note in [*self.notes(), *causes])])
