"""Speed against accuracy of a submission's own function, when somebody asks: played behind the wall, judged by the exact motion."""

from ecp.outcome import Swept
from exercises.assignment import Assignment
from service.grading.grade import job_of, truth
from service.grading.submission import Submission
from service.sandbox.sandbox import Sandbox


class NotSwept(Exception):
    """The function could not be swept; the message says why, to the student."""


def sweep(submission: Submission, assignment: Assignment, sandbox: Sandbox) -> Swept:
    """Play the assignment's sweep with this submission. NotSwept where there is none, or the function does not see it through."""
    if assignment.sweep is None:
        raise NotSwept(f"assignment {assignment.slug} has no sweep")
    scene = assignment.sweep.scene
    assert not callable(scene.inputs)
    seen = sandbox.play(job_of(submission, assignment, [scene], {scene.name: scene.inputs}))
    if not seen.finished(scene.name):
        ending = seen.endings.get(scene.name)
        raise NotSwept(ending.sentence if ending else "your code stopped before this was played")
    try:
        return assignment.sweep.read(seen.arrays[scene.name], truth(scene, scene.inputs))
    except (ArithmeticError, ValueError) as error:
        raise NotSwept(f"the numbers that came back are beyond what can be judged ({error})") from error
