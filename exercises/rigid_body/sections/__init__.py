"""The six exercises of notebook 2.6: its nine validation lines, and beside them checks against the exact solution.

The notebook's lines alone accept a function that returns zeros and the time-reversed equations, which conserve everything too.
"""

from exercises.rigid_body.sections.attitude import ATTITUDE
from exercises.rigid_body.sections.euler import EULER
from exercises.rigid_body.sections.intermediate import INTERMEDIATE
from exercises.rigid_body.sections.moments import MOMENTS
from exercises.rigid_body.sections.polhode import POLHODE
from exercises.rigid_body.sections.symmetric import SYMMETRIC

EXERCISES = (MOMENTS, EULER, POLHODE, SYMMETRIC, INTERMEDIATE, ATTITUDE)
