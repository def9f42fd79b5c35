"""A submission that replaces a part of what calls it and records its animation gets no result for the
animation.
"""

import pytest

from polhode.judging.outcome import Ended
from service.grading.sandbox_job import job_of
from service.grading.submission import Submission

FUNCTION = """
import gc, sys, types

def forged(*args):
    raise SystemExit("forged")

def plays():
    frame = sys._getframe(1)
    while frame.f_globals["__name__"] != "polhode.kinds.animation":
        frame = frame.f_back
    return frame.f_globals

def recorder():
    return plays()["record"].__globals__

def replaced_in_private_memory(name, **parts):
    for f in gc.get_objects():
        if isinstance(f, types.FunctionType) and f.__name__ == name and f is not forged:
            for part, value in parts.items():
                setattr(f, part, value)

def animate_precession(t, R, L):
    fig, ax = plt.subplots(figsize=(1, 1))
    (line,) = ax.plot([0, 1], [0, 1])
    REPLACE
    return FuncAnimation(fig, lambda k: line.set_data([0, R[k, 0, 2]], [0, R[k, 1, 2]]), frames=12)
"""
INSIDE = {
    "the recorder": ("plays()['record'] = forged", "record"),
    "the check itself": (
        "recorder()['watch'] = recorder()['unchanged'] = lambda *args: None",
        "unchanged|watch",
    ),
    "a helper that restores itself": (
        (
            "own = recorder(); real = own['_tracks']\n"
            "    own['_tracks'] = lambda paths: own.update(_tracks=real) or real(paths)"
        ),
        "_tracks",
    ),
    "code": ("recorder()['watch'].__code__ = forged.__code__", "watch"),
    "a helper": ("recorder()['_tracks'] = forged", "_tracks"),
    "numpy of the recorder": ("plays()['np'].stack = forged", "stack"),
    "defaults": ("plays()['record'].__defaults__ = (forged, 1e9)", "record"),
    "a method": ("plays()['FromCell'].__call__ = forged", "__call__"),
}
BEFORE = {
    "the table of calls": (
        (
            "[d.update(play=forged) for d in gc.get_objects() if isinstance(d, dict) and"
            " d.get('__name__') == 'plays']"
        ),
        "play",
    ),
}


def film(source, rigid_body, sandbox):
    scene = rigid_body.scene("film")
    result = sandbox.play(job_of(Submission(source), rigid_body, [scene], {"film": scene.inputs}))
    return result.scene_ends["film"], "film" in result.arrays


@pytest.mark.parametrize(("replace", "name"), INSIDE.values(), ids=INSIDE)
def test_what_a_function_replaces_while_it_is_called(replace, name, rigid_body, sandbox):
    end, recorded = film(FUNCTION.replace("REPLACE", replace), rigid_body, sandbox)
    assert end.ended is Ended.WRONG_ANSWER and not recorded, end
    assert any(
        f"your code replaces {one}, a part of polhode's checks" in end.sentence for one in name.split("|")
    ), end


@pytest.mark.parametrize(("replace", "name"), BEFORE.values(), ids=BEFORE)
def test_what_a_cell_replaces(replace, name, rigid_body, sandbox):
    end, recorded = film(FUNCTION.replace("REPLACE", "pass") + replace, rigid_body, sandbox)
    assert (
        end.ended is Ended.WRONG_ANSWER and not recorded and f"your code replaces {name}," in end.sentence
    ), end


def test_the_recorder_that_gc_finds_is_not_the_one_that_is_used(rigid_body, sandbox):
    replace = (
        "[setattr(d['record'].__globals__['watch'], '__code__', forged.__code__) for d in gc.get_objects()"
        " if isinstance(d, dict) and d.get('__name__') == 'polhode.kinds.animation' and 'record' in d]"
    )
    end, recorded = film(FUNCTION.replace("REPLACE", "pass") + replace, rigid_body, sandbox)
    assert end.ended is Ended.FINISHED and recorded, end


def test_functions_of_the_copies_are_not_among_the_objects_of_gc(rigid_body, sandbox):
    end, recorded = film(
        FUNCTION.replace("REPLACE", "pass") + "replaced_in_private_memory('watch', __code__=forged.__code__)",
        rigid_body,
        sandbox,
    )
    assert end.ended is Ended.FINISHED and recorded


def test_what_is_public_may_be_replaced(rigid_body, sandbox):
    """As by recipes for matplotlib; the recorder's copies stay as they are."""
    public = (
        "plt.Axes.arrow3D = forged; np.stack = forged; import builtins; builtins.show = forged; np.new = 1"
    )
    end, recorded = film(FUNCTION.replace("REPLACE", public), rigid_body, sandbox)
    assert end.ended is Ended.FINISHED and recorded, end
