"""The release names the pictures of the docs that show former templates."""

import pytest

from tests.support import release
from tests.support.pictures import shown

PAGE, NOTEBOOK = "docs/pages/class-dark.png", "docs/notebook.png"
TEMPLATE, STYLE_SHEET = "service/pages/templates/report.html", "service/pages/static/polhode.css"
OF_KIT = "exercises/kit/polhode/report/report_html.py"


@pytest.fixture
def clone(tmp_path):
    """A clone whose pictures are up to date."""
    for name in (PAGE, NOTEBOOK, TEMPLATE, STYLE_SHEET, OF_KIT):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("as it was")
    shown.record([tmp_path / PAGE, tmp_path / NOTEBOOK], tmp_path)
    return tmp_path


def test_pictures_of_the_present_templates_are_in_order(clone, capsys):
    (clone / TEMPLATE).touch()
    (clone / "service/pages/account.py").write_text("what a page is made of is not how it looks")
    release.examine_pictures(clone)
    assert "show the present templates" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("changed", "named"),
    [(TEMPLATE, [PAGE]), (STYLE_SHEET, [PAGE]), (OF_KIT, [NOTEBOOK, PAGE])],
)
def test_a_change_is_noticed_in_the_pictures_that_show_it(clone, changed, named):
    (clone / changed).write_text("as it is now")
    assert shown.outdated(clone) == named
    with pytest.raises(release.Refused, match=f"{named[-1]} shows former templates: run make pictures"):
        release.examine_pictures(clone)


def test_a_new_template_and_a_picture_without_record_are_noticed(clone):
    (clone / "docs/drawn-by-hand.png").write_text("new")
    assert shown.outdated(clone) == ["docs/drawn-by-hand.png"]
    (clone / "service/pages/templates/new.html").write_text("new")
    assert shown.outdated(clone) == ["docs/drawn-by-hand.png", PAGE]


def test_drawing_one_picture_leaves_the_others_outdated(clone):
    (clone / OF_KIT).write_text("as it is now")
    shown.record([clone / NOTEBOOK], clone)
    assert shown.outdated(clone) == [PAGE]


def test_a_picture_of_an_example_is_outdated_when_the_example_changes(clone):
    page = clone / "docs/authors/steps.md"
    page.parent.mkdir()
    page.write_text("# Steps\n\n```python\nx = 1\n```\n")
    page.with_suffix(".png").write_text("drawn")
    shown.record([page.with_suffix(".png")], clone)
    page.write_text("# One step\n\n```python\nx = 1\n```\n")
    assert shown.outdated(clone) == []
    page.write_text("# One step\n\n```python\nx = 2\n```\n")
    assert shown.outdated(clone) == ["docs/authors/steps.png"]


def test_the_record_forgets_a_deleted_picture(clone):
    (clone / PAGE).unlink()
    shown.record([clone / NOTEBOOK], clone)
    assert shown.outdated(clone) == []
