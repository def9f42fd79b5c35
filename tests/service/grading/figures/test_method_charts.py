"""The measurement of the reference methods: the one that comes along, the command, and the page."""

import json
import re

import pytest

from service.cli.__main__ import main
from service.grading.figures import method_charts
from service.grading.figures.chart_drawing import draw
from tests.support.asgi import visit

DOCUMENT = method_charts.load()
MOST_PAGE, MOST_DATA = 150_000, 300_000


def test_the_measurement_that_comes_along_supports_every_claim_and_is_small():
    claims = [claim for part in ("scenes", "pictures") for one in DOCUMENT[part] for claim in one["claims"]]
    claims += DOCUMENT["unfailing"]
    assert len(claims) > 25 and all(holds for _, holds in claims)
    assert len(DOCUMENT["least"]) == 9 and all(row[-1] for row in DOCUMENT["least"])
    assert DOCUMENT["measured_at"] and DOCUMENT["versions"]["numpy"]
    assert method_charts.MEASURED.stat().st_size < MOST_DATA


def test_the_claims_that_come_along_are_those_of_their_numbers():
    from reference.charts import cost, failures

    for scene in DOCUMENT["scenes"]:
        made = cost.claims([cost.Point(*point) for point in scene["points"]], scene["floor"])
        assert [[*claim] for claim in made] == scene["claims"], scene["name"]
    for picture, shown in zip(failures.PICTURES, DOCUMENT["pictures"], strict=True):
        curves = {curve[0]: failures.Curve(*curve) for curve in shown["curves"]}
        assert [[*claim] for claim in picture.claims(curves)] == shown["claims"], picture.title


@pytest.mark.parametrize("number", range(method_charts.count(DOCUMENT, "cost")))
def test_a_chart_of_cost_names_its_steppers_the_closed_form_and_the_price_of_python(number):
    svg = draw(method_charts.chart(DOCUMENT, "cost", number)).decode()
    names = re.findall(r'class="name c\d">([^<]+)<', svg)
    heavy = DOCUMENT["scenes"][number]["name"] == "heavy top"
    assert {"RK4", "DOP853", "splitting 6", "closed form"} <= set(names) and len(names) == 7 - heavy
    assert (
        re.search(r">in SciPy: ×\d+<", svg)
        and "CPU time / µs" in svg
        and ("(κ + angle)·2⁻⁵²" in svg) != heavy
    )


def test_one_command_measures_and_draws_everything(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(method_charts, "measure", lambda: DOCUMENT)
    assert main(["chart", "--out", str(tmp_path / "new")]) == 0
    assert json.loads((tmp_path / "new" / "reference.json").read_text()) == DOCUMENT
    drawn = {path.name for path in (tmp_path / "new").glob("*.svg")}
    assert drawn == {f"cost-{n}.svg" for n in range(6)} | {f"failure-{n}.svg" for n in range(6)}


@pytest.mark.slow
def test_what_the_command_measures_is_the_same_but_for_times(capsys):
    fresh = method_charts.measure()
    assert fresh.keys() == DOCUMENT.keys()
    assert [s["name"] for s in fresh["scenes"]] == [s["name"] for s in DOCUMENT["scenes"]]
    for old, new in zip(DOCUMENT["pictures"], fresh["pictures"], strict=True):
        assert [(name, x) for name, x, _ in old["curves"]] == [(name, x) for name, x, _ in new["curves"]]
    assert "measuring exercise 2" in capsys.readouterr().out


@pytest.mark.slow
def test_the_page_answers_three_questions_with_the_figures_of_one_scene(database_url):
    paths = [f"/reference/{kind}-{n}.svg" for kind in ("cost", "failure") for n in range(6)]
    page, other, none, unknown, *drawn = visit(
        database_url,
        "/reference",
        "/reference?scene=5",
        "/reference?scene=6",
        "/reference/cost-6.svg",
        *paths,
    )
    assert none.status_code == unknown.status_code == 404
    assert DOCUMENT["measured_at"] in page.text and "numpy" in page.text
    for id in ("cost", "failures", "least"):
        assert f'id="{id}"' in page.text
    shown = re.findall(r'src="(/reference/[^"]+)"', page.text)
    assert shown == [paths[0], *paths[6:]] and "/reference/cost-5.svg" in other.text
    assert "✗" not in page.text and 'aria-current="true">Heavy top' in other.text
    sizes = {path: len(answer.content) for path, answer in zip(paths, drawn, strict=True)}
    assert len(page.content) + sum(sizes[path] for path in shown) < MOST_PAGE
    assert all(answer.headers["content-type"].startswith("image/svg") for answer in drawn)
