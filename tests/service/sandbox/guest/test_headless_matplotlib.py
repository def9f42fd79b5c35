"""Drawing without a screen and without LaTeX: whatever backend a submission names, Agg draws."""

import pytest

from exercises.authoring.assignments.assignment import ArraySpec
from polhode.judging.outcome import Ended
from service.sandbox.guest.headless_matplotlib import NO_LATEX
from service.sandbox.job import Cell, Job, SceneRequest

PLAYS = "def ask(student, inputs):\n    return {'x': student['f']()}"
NAMED = [
    "matplotlib.use('GTK4Agg')",
    "matplotlib.use('Qt4Agg', force=True)",
    "matplotlib.use('WebAgg'); import matplotlib.pyplot as plt",
    "plt.switch_backend('MacOSX')",
    "plt.switch_backend('module://my_own.backend')",
    "matplotlib.rcParams['backend'] = 'WX'",
    "plt.rcParams.update({'backend': 'ipympl'})",
    "matplotlib.rcParams.update(backend='notebook')",
    "import os; os.environ['MPLBACKEND'] = 'TkCairo'",
    "matplotlib.use('pgf')",
]
WINDOW = [
    "fig.canvas.manager.set_window_title('film')",
    "plt.get_current_fig_manager().window.state('zoomed')",
    "plt.get_current_fig_manager().window.setGeometry(0, 0, fig.canvas.manager.window.width() // 2, 400)",
    "plt.get_current_fig_manager().full_screen_toggle(); plt.get_current_fig_manager().resize(3, 4)",
    "plt.get_current_fig_manager().frame.Maximize(True)",
    "fig.canvas.manager.toolbar.pan(); fig.canvas.toolbar.home()",
    "fig.canvas.layout.width = '100%'; fig.canvas.header_visible = False",
    "fig.canvas.get_tk_widget().focus_force()",
    "plt.ion(); plt.show(block=True); fig.show()",
    "fig.canvas.draw_idle(); fig.canvas.flush_events(); fig.canvas.start_event_loop(0)",
    "assert plt.ginput(1, timeout=0) == [] and plt.waitforbuttonpress() is None",
    "[plt.pause(1) for _ in range(100)]",
    "fig.canvas.new_timer(interval=10, callbacks=[(print, (), {})]).start()",
]
LATEX = [
    "plt.rc('text', usetex=True); plt.title(r'$\\dfrac{1}{2}$')",
    "matplotlib.rcParams['text.usetex'] = 'on'; plt.xlabel(r'\\textbf{x} in \\%')",
    "plt.title(r'\\LaTeX and $\\omega_1$', usetex=True); plt.title('again', usetex=True)",
    "plt.rcParams.update({'text.usetex': True, 'text.latex.preamble': r'\\usepackage{amsmath}'});"
    " plt.ylabel(r'$\\begin{pmatrix} a \\end{pmatrix}$')",
]
DRAWS = """
fig, axes = plt.subplots()
{}
axes.plot([0, 1])
fig.canvas.draw()
f = lambda: float(len(fig.canvas.buffer_rgba()) > 0)
"""


def played(sandbox, *lines):
    source = "\n".join(["import matplotlib", "import matplotlib.pyplot as plt", *lines])
    scene = SceneRequest("one", "ask", "f", {}, {"x": ArraySpec(())}, 2.0, None)
    result = sandbox.play(Job("", PLAYS, (Cell("submission.py", source),), ("f",), (scene,)))
    ended = next(iter(result.cells.values()), result.scene_ends["one"])
    assert ended.ended is Ended.FINISHED and result.arrays["one"]["x"] == 1, ended
    return result.stdout


@pytest.mark.parametrize("line", NAMED)
def test_a_named_backend_draws_silently(sandbox, line):
    assert played(sandbox, line, DRAWS.format("")) == ""


@pytest.mark.parametrize("line", WINDOW)
def test_a_window_is_not_there_and_nobody_is_waited_for(sandbox, line):
    assert played(sandbox, "plt.switch_backend('TkAgg')", DRAWS.format(line)) == ""


@pytest.mark.parametrize("line", LATEX)
def test_text_for_latex_is_drawn_by_mathtext_which_is_said_once(sandbox, line):
    assert played(sandbox, DRAWS.format(line)) == f"{NO_LATEX}\n"


def test_without_latex_asked_for_invalid_mathtext_is_an_error(sandbox):
    raises = "try:\n    fig.canvas.draw()\n    1 / 0\nexcept ValueError:\n    axes.set_title('')"
    assert played(sandbox, DRAWS.format(f"axes.set_title(r'$\\nosuch$')\n{raises}")) == ""


def test_usetex_that_is_off_is_silent(sandbox):
    assert played(sandbox, "plt.rc('text', usetex=False)", DRAWS.format("plt.title('t', usetex=False)")) == ""


def test_a_backend_named_in_a_notebook(sandbox):
    magics = ("%matplotlib widget", "%matplotlib qt", "%config InlineBackend.figure_format = 'retina'")
    assert played(sandbox, *magics, DRAWS.format("")) == ""
