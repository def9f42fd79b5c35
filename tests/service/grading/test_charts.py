"""The charts: measured by the command, shown on the page with date and versions."""

import csv
import itertools
import json
import re

import pytest

from ecp.outcome import SweptPoint
from exercises.catalogue import find
from service.cli.__main__ import main
from service.grading import chart_drawing, charts
from tests.support.asgi import visit


@pytest.mark.slow
def test_work_precision_writes_csv_json_and_svg(tmp_path, monkeypatch, capsys):
    from reference import work_precision
    from reference.methods import METHODS

    few = [m for m in METHODS if m.name in ("Euler", "RK4", "exact", "DOP853")]
    real = work_precision.measure
    monkeypatch.setattr(work_precision, "measure", lambda scenes: real(scenes, few, repeats=1))
    assert main(["chart", "work-precision", "--scene", "exercise 6", "--out", str(tmp_path)]) == 0
    document = json.loads((tmp_path / "work-precision.json").read_text())
    with (tmp_path / "work-precision.csv").open() as stream:
        assert len(list(csv.DictReader(stream))) == len(document["points"]) == 23
    assert document["measured_at"] and document["versions"]["numpy"]
    svg = (tmp_path / "work-precision-0.svg").read_text()
    assert "exercise 6" in svg and "evaluations of the right-hand side" in svg
    assert main(["chart", "work-precision", "--scene", "nowhere", "--out", str(tmp_path)]) == 2
    assert "no scene matches" in capsys.readouterr().err


@pytest.mark.slow  # each in a sandbox of its own, as the command starts it
@pytest.mark.parametrize(
    ("slug", "sample", "exercise", "scene", "labels"),
    [
        ("rigid-body", "right_terms.py", (), "exercise 2", ("yours, DOP853", "RK4")),
        ("lagrangian", None, ("--exercise", "5"), "motion of hoop_rates to t = 5", ("yours, DOP853",)),
        ("integrators", None, (), "euler_step, ", ("yours, euler_step", "yours, rk4_step")),
    ],
)
def test_a_submission_is_drawn_with_any_exercise_that_has_a_chart(
    slug, sample, exercise, scene, labels, tmp_path, capsys
):
    assignment, file = find(slug), tmp_path / "mine.py"
    made = (sample.source for sample in assignment.made_samples() if sample.right)
    file.write_text((assignment.folder / "samples" / sample).read_text() if sample else next(made))
    given = ["--submission", str(file), "--assignment", slug, *exercise, "--out", str(tmp_path / "out")]
    assert main(["chart", "work-precision", *given]) == 0, capsys.readouterr()
    assert capsys.readouterr().out.startswith(scene)
    assert json.loads((tmp_path / "out" / "work-precision-submission.json").read_text())["scene"].startswith(
        scene
    )
    svg = (tmp_path / "out" / "work-precision-submission.svg").read_text()
    assert all(label in svg for label in labels)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (
            ["--exercise", "1", "--submission"],
            "exercise 1 has no chart of speed against accuracy; these have one: 2",
        ),
        (["--exercise", "9", "--submission"], "9"),
        (["--scene", "x", "--submission"], "leave --scene out"),
        (["--exercise"], "add --submission FILE"),
    ],
)
def test_no_option_of_a_submission_is_ignored(given, message, tmp_path, rigid_body, capsys):
    file = rigid_body.folder / "samples" / "right_terms.py"
    assert main(["chart", "work-precision", *given, str(file), "--out", str(tmp_path)]) == 2
    assert message in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_stability_measures_the_named_scenes_only(tmp_path, capsys):
    assert main(["chart", "stability", "--scene", "phase", "--scene", "nowhere", "--out", str(tmp_path)]) == 0
    (entry,) = json.loads((tmp_path / "stability.json").read_text())["entries"]
    assert entry["name"] == "invariants hold and the phase is wrong" and entry["holds"]
    assert {path.name for path in tmp_path.iterdir()} == {
        "stability.json",
        "stability-0.csv",
        "stability-0.svg",
    }


def test_the_measurement_that_comes_along_has_matplotlib():
    document = charts.load_work_precision()
    assert len(charts.scenes(document)) == 9
    for scene in charts.scenes(document):
        points = [p for p in document["points"] if p["scene"] == scene]
        assert len({p["method"] for p in points}) >= (9 if scene.startswith("heavy top") else 14)
        exact = next(p for p in points if p["method"] == "exact")
        assert exact["error_w"] < 1e-14 and exact["ratio"] < 0.1
    assert all(entry["holds"] for entry in charts.load_stability()["entries"])


def test_what_is_accurate_and_cheaper_than_the_exact_solution_is_told_and_not_hidden():
    document = {
        "points": [
            {
                "scene": "s",
                "method": "exact",
                "line": "closed form",
                "setting": 0,
                "error_w": 0.0,
                "error_R": 0.0,
                "ratio": 0.1,
            },
            {
                "scene": "s",
                "method": "cheap",
                "line": "explicit",
                "setting": 1,
                "error_w": 1e-9,
                "error_R": 1e-9,
                "ratio": 0.05,
            },
            {
                "scene": "s",
                "method": "dear",
                "line": "explicit",
                "setting": 2,
                "error_w": 1e-9,
                "error_R": 1e-9,
                "ratio": 0.2,
            },
            {
                "scene": "s",
                "method": "coarse",
                "line": "explicit",
                "setting": 1,
                "error_w": 1e-3,
                "error_R": 1e-3,
                "ratio": 0.01,
            },
            {
                "scene": "s",
                "method": "blown up",
                "line": "explicit",
                "setting": 1,
                "error_w": None,
                "error_R": None,
                "ratio": 0.01,
            },
        ]
    }
    assert [p["method"] for p in charts.accurate(document)] == ["cheap", "dear"]
    assert [p["method"] for p in charts.cheaper(document)] == ["cheap"]


def test_what_is_cheaper_than_the_exact_solution_is_compiled_as_the_page_says():
    cheaper = charts.cheaper(charts.load_work_precision())
    assert cheaper and {p["line"] for p in cheaper}.isdisjoint({"adaptive", "closed form"})


def made(cost, error, method="m", line="explicit"):
    return {
        "scene": "s",
        "method": method,
        "line": line,
        "calls": cost,
        "ratio": cost,
        "error_w": error,
        "error_R": 0.0,
    }


def test_the_pareto_front_has_what_nothing_beats():
    best = [made(1, 1e-1), made(3, 1e-4), made(9, 1e-9)]
    beaten = [
        made(2, 1e-1),
        made(3, 1e-3),
        made(10, 1e-9),
        made(4, None),
        made(1, 1e-16, "exact", "closed form"),
    ]
    assert chart_drawing.front([*beaten, *reversed(best)], "calls") == best
    assert chart_drawing.front([], "calls") == []


def words(svg):
    return re.findall(r"<text[^>]*>([^<]+)</text>", svg.decode())


@pytest.mark.slow
@pytest.mark.parametrize("number", range(9))
def test_a_chart_of_speed_names_every_method_beside_its_curve(number):
    document = charts.load_work_precision()
    scene = charts.scenes(document)[number]
    shown = words(chart_drawing.draw_work_precision(document, scene))
    methods = {
        p["method"]
        for p in document["points"]
        if p["scene"] == scene and p["line"] != "closed form" and charts.error(p) is not None
    }
    assert {chart_drawing.SHORT.get(one, one) for one in methods} | {"exact"} <= set(shown)


@pytest.fixture(scope="module")
def drawn():
    """The words of each entry of the atlas."""
    document = charts.load_stability()
    return [words(chart_drawing.draw_stability(document, n)) for n in range(len(document["entries"]))]


@pytest.mark.slow
@pytest.mark.parametrize("number", range(10))
def test_each_entry_of_the_atlas_shows_its_own_quantity_with_labelled_axes(number, drawn):
    document = charts.load_stability()
    assert drawn[number] not in [*drawn[:number], *drawn[number + 1 :]]
    entry = document["entries"][number]
    columns = chart_drawing.ATLAS.get(entry["name"])
    if columns:
        assert {chart_drawing.XLABELS[columns[0]], columns[2]} <= set(drawn[number])
        names = set(columns[1].values()) - {""} or {r["method"] for r in entry["rows"]}
        assert all(any(name in word for word in drawn[number]) for name in names)


def test_a_drawing_leaves_the_style_of_later_figures_unchanged(drawn):
    import matplotlib as mpl

    assert drawn and mpl.rcParams["axes.grid"] is mpl.rcParamsDefault["axes.grid"] is False
    assert mpl.rcParams["font.size"] == mpl.rcParamsDefault["font.size"]


def test_a_method_that_diverges_at_every_step_says_so():
    document = charts.load_stability()
    (number,) = [n for n, entry in enumerate(document["entries"]) if entry["name"] == "large steps blow up"]
    assert "Euler: diverges" in words(chart_drawing.draw_stability(document, number))


@pytest.mark.parametrize("heights", [(1.0,) * 5, (1e-9, 1e-9, 1e5), (1e-30,) * 3, (1e-3, 1e-9)])
def test_names_beside_curves_do_not_overlap_and_stay_at_the_axes(heights):
    canvas = chart_drawing._canvas(3.0)
    axes = canvas.subplots()
    axes.set(yscale="log", ylim=(1e-16, 1e2))
    chart_drawing._label_ends(axes, [(1.0, y, str(k), "k") for k, y in enumerate(heights)])
    places = sorted(one.xy[1] for one in axes.texts)
    assert len(places) == len(heights) and places[0] >= 0 and places[-1] <= 1
    gap = chart_drawing.GAP / (axes.get_position().height * 3.0 * 72)
    assert all(b - a > 0.999 * gap for a, b in itertools.pairwise(places))


def test_the_key_of_a_class_names_each_method_once():
    methods = [SweptPoint(method, 1e-11, 1000, 1e-10, 0.01) for method in ("DOP853", "RK45")]
    drawn = chart_drawing.draw_class(
        charts.load_work_precision(), "exercise 2", [methods, methods[:1], methods[1:]]
    ).decode()
    assert [drawn.count(f">class, {method}<") for method in ("DOP853", "RK45")] == [1, 1]
    assert ">class, " not in chart_drawing.draw_class(charts.load_work_precision(), "exercise 2", []).decode()


@pytest.mark.slow
def test_the_page_shows_every_chart_and_when_and_with_what_it_was_measured(database_url):
    drawn = ["work-precision/0", "work-precision/8", *(f"stability/{n}" for n in range(10))]
    page, none, *answers = visit(
        database_url,
        *(f"/reference{path}" for path in ("", "/stability/10.svg", *(f"/{d}.svg" for d in drawn))),
    )
    assert (
        charts.load_work_precision()["measured_at"] in page.text
        and "numpy" in page.text
        and page.text.count("<figure>") == 19
    )
    assert none.status_code == 404
    for chart, answer in zip(drawn, answers, strict=True):
        assert answer.headers["content-type"].startswith("image/svg") and "<svg" in answer.text, chart
