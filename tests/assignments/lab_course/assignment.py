"""An assignment for tests: functions that depend on each other, variables, a class, and data files."""

import numpy as np

from exercises.authoring import Notebook, close

notebook = Notebook("notebook.ipynb", data=("points.csv", "runs/first.csv"))
WHOLE = close(rtol=1e-12, atol=1e-12, because="a few operations with small whole numbers")
X = [0.0, 1.0, 2.0]


@notebook.exercise("1", "A model")
def a_model(ask):
    """The line through zero, and how far points are from it."""
    model = ask.function("model", label="the model is 2x")
    model.case("", x=X)

    @model.truth(agree=WHOLE)
    def line(x):
        """Twice x."""
        return 2 * np.array(x)

    residual = ask.function("residual", label="the misfit of the model")
    residual.case("", predicted=[0.0, 2.0, 4.0], y=X)

    @residual.truth(agree=WHOLE)
    def squares(predicted, y):
        """The sum of the squares."""
        return float(np.sum((np.array(predicted) - np.array(y)) ** 2))


@notebook.exercise("2", "Files")
def files(ask):
    """What reads files."""
    total = ask.function("total", label="the sum of both files")

    @total.truth(agree=WHOLE)
    def by_hand():
        """1 + 2 of the one, 3 of the other."""
        return 6.0


@notebook.exercise("3", "Values")
def constants(ask):
    """Variables of cells."""
    ask.cell("slope").truth("slope", 2.0, agree=WHOLE)
    ask.cell("g").truth("g", 9.81, agree=WHOLE)


@notebook.exercise("4", "A class")
def a_class(ask):
    """An object that counts."""
    steps = ask.function("Pendulum", label="three steps")

    @steps.observe
    def counted(Pendulum):
        """Return the count after three steps."""
        pendulum = Pendulum()
        for _ in range(3):
            pendulum.step()
        return float(pendulum.count)

    @steps.truth(agree=WHOLE)
    def three():
        """Each step counts one."""
        return 3.0
