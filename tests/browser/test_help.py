"""Help: the dialog behind the "?" of every page, and the page it leads to."""


def test_the_question_mark_is_help(page, application):
    page = page()
    page.goto(f"{application.url}/login")
    page.get_by_role("button", name="Help").click()
    page.get_by_role("dialog", name="Help").get_by_role("link").click()
    page.get_by_role("heading", name="Help", level=1).wait_for()
    assert page.get_by_role("heading", name="Read a report").is_visible()
    assert page.get_by_role("heading", name="For the course staff").count() == 0
