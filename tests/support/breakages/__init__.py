"""Deliberate breakages of the product, a line each, with the tests that must notice: what ``python -m
tests.sabotage`` tries.

A breakage is something a careless colleague could write, and its effect is a real defect. Its tests are the
cheapest that there are for it.
"""

from tests.support.breakages.breakage import Breakage
from tests.support.breakages.grading import GRADING
from tests.support.breakages.kit import KIT
from tests.support.breakages.physics import PHYSICS
from tests.support.breakages.sandbox import SANDBOX
from tests.support.breakages.store import STORE
from tests.support.breakages.web import WEB

BREAKAGES = [*PHYSICS, *KIT, *SANDBOX, *GRADING, *STORE, *WEB]

__all__ = ["BREAKAGES", "Breakage"]
