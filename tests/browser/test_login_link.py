"""A link with a token, as ``make demo`` prints it: the token is filled in, and no server sees it before."""

from tests.support.database import entered


def test_a_link_fills_the_token_in_and_leaves_the_address(page, application, url):
    page, asked = page(), []
    page.on("request", lambda request: asked.append(request.url))
    token = entered(url, "ann")
    page.goto(f"{application.url}/login#token={token}")
    field = page.get_by_label("Token from your course")
    page.wait_for_function("() => !location.hash")
    assert field.input_value() == token and not any(token in one for one in asked)
    page.get_by_role("button", name="Log in").click()
    page.locator("nav .me").wait_for()
    assert page.locator("nav .me").inner_text() == "ann"
