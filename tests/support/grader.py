"""A grader that polhode itself prevents from grading."""

from service.grading.grader import Grader
from service.sandbox.isolation.levels import process_isolation
from service.sandbox.result import SystemFault
from service.sandbox.sandbox import Sandbox

WHY = "the sandbox does not start"


class NoSandbox(Grader):
    def __init__(self):
        super().__init__(Sandbox(process_isolation()))

    def ready(self):
        raise SystemFault(WHY)
