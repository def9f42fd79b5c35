"""The player of motions and the manners of our pages, with real clicks and keys."""

import json
import re
import urllib.request

import pytest

pytestmark = pytest.mark.slow  # test_pages.py plays a motion
SLUG = "/v1/assignments/rigid-body/submissions"
REVERSED = "def euler_eqs(t, w, I):\n    return -np.cross(I * w, w) / I\n"
PIXELS = "canvas => canvas.toDataURL()"
SECURE = {"content-security-policy": "default-src 'self'; img-src 'self' data:"}
BARE = """<!doctype html><html lang="en"><head><meta charset="utf-8"><title>bare</title>
<link rel="icon" href="data:,"><link rel="stylesheet" href="/static/polhode.css">
<script type="module" src="/static/polhode.js"></script></head>
<body><header><nav></nav></header><main>%s</main></body></html>"""


def send(server, source, wait=60, exercises=("2",)):
    body = json.dumps({"source": source, "filename": "mine.py", "exercises": list(exercises)}).encode()
    headers = {"Content-Type": "application/json", "Prefer": f"wait={wait}"}
    with urllib.request.urlopen(
        urllib.request.Request(server.url + SLUG, body, headers), timeout=90
    ) as answer:
        return json.loads(answer.read())


@pytest.fixture(scope="module")
def reversed_motion(server):
    return f"{server.url}/submissions/{send(server, REVERSED)['id']}"


def player(page, url):
    """The figure of the first motion, its canvas and the button, once it is drawn."""
    page.goto(url)
    figure = page.locator("figure.motion").first
    figure.locator("button").wait_for()
    figure.scroll_into_view_if_needed()
    return figure, figure.locator("canvas"), figure.locator("button")


def moves(page, canvas):
    """Whether the picture becomes another within some seconds, however slow the machine is."""
    before = canvas.evaluate(PIXELS)
    return any(page.wait_for_timeout(100) or canvas.evaluate(PIXELS) != before for _ in range(60))


def stands(page, canvas):
    before = canvas.evaluate(PIXELS)
    page.wait_for_timeout(600)
    return canvas.evaluate(PIXELS) == before


def bare(page, server, content):
    """A page of this content under our CSP, with our own script."""
    page.route(
        "**/bare",
        lambda route: route.fulfill(body=BARE % content, headers={**SECURE, "content-type": "text/html"}),
    )
    page.goto(server.url + "/bare")
    page.locator("button.keys").wait_for()


def focused(page):
    return page.evaluate("document.activeElement.textContent.trim()")


def test_it_plays_by_itself_once_and_pauses(page, reversed_motion):
    page = page()
    figure, canvas, button = player(page, reversed_motion)
    figure.get_by_role("button", name="Pause").wait_for()
    assert moves(page, canvas)
    button.click()
    assert button.inner_text() == "▶ Play" and stands(page, canvas)
    figure.get_by_role("slider").fill("19900")
    button.click()
    figure.get_by_role("button", name="Play").wait_for()
    assert figure.locator(".at").inner_text().startswith("20.00 s") and stands(page, canvas)


def test_with_reduced_motion_it_stands_still_until_asked(page, reversed_motion):
    page = page(reduced_motion="reduce")
    figure, canvas, button = player(page, reversed_motion)
    page.wait_for_timeout(500)
    assert button.inner_text() == "▶ Play" and stands(page, canvas)
    apart = re.search(r"s, ([\d.]+)° apart", figure.locator(".at").inner_text())
    farthest = re.search(r"by ([\d.]+)°", figure.locator("figcaption").inner_text())
    assert abs(float(apart[1]) - float(farthest[1])) < 2, "it shows where the motions differ most"
    button.click()
    assert moves(page, canvas)
    assert float(figure.locator(".at").inner_text().split(" s")[0]) < 10, "it plays from the beginning"


def test_scrubbing_dragging_and_arrow_keys_change_the_picture(page, reversed_motion):
    page = page(reduced_motion="reduce")
    figure, canvas, _ = player(page, reversed_motion)
    seen = [canvas.evaluate(PIXELS)]

    def changed():
        seen.append(canvas.evaluate(PIXELS))
        assert seen[-1] not in seen[:-1]

    slider = figure.get_by_role("slider", name="Time")
    slider.fill("10000")
    changed()
    assert slider.get_attribute("aria-valuetext") == figure.locator(".at").inner_text()
    assert (
        figure.locator(".at").inner_text().startswith("10.00 s, ")
        and "0.0°" not in figure.locator(".at").inner_text()
    )
    slider.press("ArrowRight")
    assert slider.input_value() == "10001"
    box = canvas.bounding_box()
    page.mouse.move(box["x"] + 80, box["y"] + 80)
    page.mouse.down()
    page.mouse.move(box["x"] + 180, box["y"] + 120, steps=4)
    page.mouse.up()
    changed()
    page.mouse.move(box["x"] + 90, box["y"] + 90, steps=2)
    assert canvas.evaluate(PIXELS) == seen[-1], "it is let go"
    for key in ("ArrowLeft", "ArrowDown"):
        canvas.press(key)
        changed()


def test_it_is_named_crisp_and_fits_a_phone_in_dark(page, reversed_motion):
    found = []
    for scheme in ("light", "dark"):
        small = page(
            width=360, height=740, device_scale_factor=2, color_scheme=scheme, reduced_motion="reduce"
        )
        figure, canvas, _ = player(small, reversed_motion)
        assert small.evaluate("document.documentElement.scrollWidth") <= 360
        assert canvas.evaluate("c => c.width") == 2 * canvas.evaluate("c => c.clientWidth")
        named = figure.get_by_role(
            "img", name="The body in space, turned by your equations. Two boxes turning"
        )
        assert named.count() == 1 and "Farthest apart at t =" in figure.locator("figcaption").inner_text()
        found.append(canvas.evaluate(PIXELS))
    assert found[0] != found[1]


def test_without_scripts_figures_and_words_are_there_and_no_empty_player(page, reversed_motion):
    plain = page(java_script_enabled=False)
    plain.goto(reversed_motion)
    assert (
        not plain.locator("figure.motion").first.is_visible()
        and plain.locator("figure img").first.is_visible()
    )


def test_a_page_is_renewed_while_it_is_graded_without_being_loaded_again(page, server):
    sent = send(server, "import time\ntime.sleep(3)\n" + REVERSED, wait=0)
    page = page()
    page.goto(f"{server.url}/submissions/{sent['id']}")
    page.evaluate("window.been = true")
    page.locator(".outcomes li").first.wait_for()
    assert page.evaluate("window.been") and "public checks: 2 of 3" in page.locator("main").inner_text()
    assert page.locator("#submission").get_attribute("data-live") is not None
    page.locator("figure.motion canvas").first.wait_for(state="visible")


def test_what_is_focused_or_opened_stays_when_a_part_is_renewed_and_a_lost_connection_is_told(page, server):
    opened = page
    page = opened()
    opened.allowed = ["ERR_FAILED"]
    parts = "<details><summary>more</summary>inside</details><a href='#x'>one %d</a>"
    content = f'<div id="part" data-live="/stream" data-events="tick">{parts}</div>'
    served = []

    def stream(route):
        if served:
            return route.abort()
        served.append(1)
        route.fulfill(
            body="retry: 100\nevent: tick\ndata: 1\n\n", headers={"content-type": "text/event-stream"}
        )

    looked = []

    def show(route):
        looked.append(1)
        route.fulfill(body=BARE % (content % len(looked)), headers={**SECURE, "content-type": "text/html"})

    page.route("**/bare", show)
    page.route("**/stream", lambda route: held.append(route))
    held = []
    page.goto(server.url + "/bare")
    page.locator("button.keys").wait_for()
    page.locator("summary").click()
    page.locator("a[href='#x']").focus()
    stream(held[0])
    page.get_by_text("one 2").wait_for()
    assert focused(page) == "one 2" and page.locator("details").get_attribute("open") is not None
    for _ in range(50):
        if len(held) > 1:
            break
        page.wait_for_timeout(100)
    stream(held[1])
    page.get_by_text("Connection lost").wait_for()


ROWS = """<label data-js hidden>Filter <input type="search" data-filter="people"></label>
<table id="people" data-rows><tbody>
<tr><th scope="row"><a href="/static/polhode.css">Zoë</a></th></tr>
<tr><th scope="row"><a href="/static/polhode.js">Ben</a></th></tr>
<tr><th scope="row"><a href="/static/player.js">Bea</a></th></tr></tbody></table>"""


def test_keys_go_through_rows_and_open_them(page, server):
    page = page()
    bare(page, server, ROWS)
    told = []
    for key in "jjkjjj":
        page.keyboard.press(key)
        told.append(focused(page))
    assert told == ["Zoë", "Ben", "Zoë", "Ben", "Bea", "Bea"]
    page.keyboard.press("Control+k")
    page.keyboard.press("ArrowUp")
    assert focused(page) == "Ben"
    assert page.locator("tr[tabindex='0']").count() == 1
    page.keyboard.press("o")
    page.wait_for_url("**/static/polhode.js")


def test_enter_opens_a_row_and_a_letter_in_a_field_is_a_letter(page, server):
    page = page()
    bare(page, server, ROWS)
    page.keyboard.press("/")
    page.keyboard.type("jo")
    assert page.locator("input").input_value() == "jo" and page.locator("tr:visible").count() == 0
    assert page.locator("[aria-live]").inner_text() == "0 of 3 rows"
    page.locator("input").fill("ZOE")
    assert (
        page.locator("tr:visible").all_inner_texts() == ["Zoë"]
        and page.locator("[aria-live]").inner_text() == "1 of 3 rows"
    )
    page.locator("input").fill("be")
    page.locator("input").blur()
    page.keyboard.press("j")
    assert focused(page) == "Ben"
    page.keyboard.press("Enter")
    page.wait_for_url("**/static/polhode.js")


def test_arrows_go_through_a_grid_cell_by_cell(page, server):
    page = page()
    cells = "".join(
        f"<tr><th scope='row'>r{r}</th>"
        + "".join(f"<td><a href='#{r}{c}'>{r}{c}</a></td>" for c in "ab")
        + "</tr>"
        for r in "123"
    )
    bare(page, server, f"<table data-grid><thead><tr><th>x</th></tr></thead><tbody>{cells}</tbody></table>")
    assert page.locator("[tabindex='0']").count() == 1
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")
    told = []
    for key in (
        "ArrowRight",
        "ArrowDown",
        "ArrowRight",
        "ArrowRight",
        "Home",
        "ArrowDown",
        "ArrowDown",
        "End",
    ):
        page.keyboard.press(key)
        told.append(focused(page))
    assert told == ["1a", "2a", "2b", "2b", "r2", "r3", "r3", "3b"]
    assert page.locator("tbody [tabindex='0']").count() == 1
    page.keyboard.press("Enter")
    page.wait_for_url("**#3b")


def test_the_list_of_keys_opens_by_key_and_button_and_turns_them_off(page, server):
    page = page()
    bare(page, server, ROWS)
    page.keyboard.press("?")
    dialog = page.get_by_role("dialog", name="Help")
    assert dialog.is_visible() and "next row" in dialog.inner_text()
    page.keyboard.press("j")
    page.get_by_label("enable letter shortcuts").uncheck()
    page.keyboard.press("Escape")
    assert not dialog.is_visible()
    page.keyboard.press("j")
    assert focused(page) not in ("Zoë", "Ben", "Bea")
    page.get_by_role("button", name="Help").click()
    page.get_by_label("enable letter shortcuts").check()
    page.get_by_role("button", name="Close").click()
    page.keyboard.press("j")
    assert focused(page) == "Zoë"


def test_a_button_that_asks_first(page, server):
    page = page()
    asked, sent = [], []
    page.route(
        "**/sent",
        lambda route: (sent.append(route.request.post_data), route.fulfill(body="done", headers=SECURE))[0],
    )
    bare(
        page,
        server,
        '<form method="post" action="/sent"><button name="do" value="it" data-confirm="Really?">Do'
        " it</button></form>",
    )

    def answer(dialog):
        asked.append(dialog.message)
        dialog.accept() if len(asked) > 1 else dialog.dismiss()

    page.on("dialog", answer)
    page.get_by_role("button", name="Do it").click()
    assert asked == ["Really?"] and not sent
    page.get_by_role("button", name="Do it").click()
    page.get_by_text("done").wait_for()
    assert sent == ["do=it"]


def test_rows_of_the_page_of_a_submission_are_rows_for_keys(page, reversed_motion):
    page = page(reduced_motion="reduce")
    page.goto(reversed_motion)
    page.locator("button.keys").wait_for()
    page.keyboard.press("j")
    assert focused(page).startswith("✓ rotational energy conserved")
    page.keyboard.press("k")
    page.locator("#timeline tbody tr").first.focus()
    page.keyboard.press("o")
    page.wait_for_url("**/submissions/*")
