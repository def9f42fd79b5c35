"""The six exercises of notebook 2.6 with their public checks: the notebook's nine lines and the exact
solution.

This folder is part of the students' kit, so that ``ecp.check`` prints the server's lines. It imports only
numpy, scipy, the kit and itself.
"""

from .attitude import ATTITUDE
from .diagnosis import diagnose
from .euler import EULER
from .intermediate import INTERMEDIATE
from .moments import MOMENTS
from .polhode import POLHODE
from .symmetric import SYMMETRIC

__all__ = ["EXERCISES", "diagnose"]

EXERCISES = (MOMENTS, EULER, POLHODE, SYMMETRIC, INTERMEDIATE, ATTITUDE)
