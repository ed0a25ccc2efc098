"""A visitor answers in Chromium: by mouse, by keyboard, on a phone, with the network going away, in a dialog."""

from __future__ import annotations

import shutil
import threading
import time

import pytest
import uvicorn
from fastapi import FastAPI
from fastapi.responses import FileResponse, HTMLResponse
from full_matrix import by_day
from survey_samples import ASSETS

import survey

pytestmark = pytest.mark.browser

FILM = ASSETS / "exhibits" / "pibo" / "baked" / "drape.webm"
FRAME = """<!doctype html><title>hall</title><script>
window.heard = []; addEventListener("message", (event) => heard.push(event.data));
</script><iframe src="/questionnaires/garment?lang=zh&exhibit=pibo" width="900" height="700"></iframe>"""


@pytest.fixture
def site(tmp_path):
    """A running server with the survey and a page that embeds it; yields (address, mounted)."""
    app = FastAPI()
    clips = {
        "pibo": survey.Clip((("/drape.webm", "video/webm"),), {"zh": "披帛垂落", "en": "The scarf falls"})
    }
    content = tmp_path / "content"
    shutil.copytree(ASSETS / "questionnaires", content / "questionnaires")
    mounted = survey.mount(app, content=content, data=tmp_path / "data", clip_of=clips.get)
    app.get("/drape.webm")(lambda: FileResponse(FILM))
    app.get("/hall", response_class=HTMLResponse)(lambda: FRAME)
    server = uvicorn.Server(uvicorn.Config(app, port=0, log_level="warning", access_log=False))
    thread = threading.Thread(target=server.run)
    thread.start()
    while not server.started:
        assert thread.is_alive()
        time.sleep(0.02)
    port = server.servers[0].sockets[0].getsockname()[1]
    yield f"http://127.0.0.1:{port}", mounted
    server.should_exit = True
    thread.join(30)
    mounted.close()


@pytest.fixture
def visit(chromium, site):
    """Open a page in a fresh context; a script error or a refused resource fails the test."""
    contexts, faults = [], []

    def opened(path, *, width=1280, height=800, **options):
        context = chromium.new_context(viewport={"width": width, "height": height}, **options)
        context.set_default_timeout(20_000)
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto(site[0] + path)
        return page

    yield opened
    for context in contexts:
        context.close()
    assert not faults


def answer_all(page, point=4):
    for item in page.locator(".item").all():
        item.locator("label.point").nth(point - 1).click()


def stored(site, key="garment"):
    mounted = site[1]
    return [row.answer for row in mounted.store.rows(mounted.questionnaires[key])]


@pytest.mark.door
def test_a_visitor_answers_and_receives_the_code(visit, site):
    page = visit("/questionnaires/garment?lang=en&exhibit=pibo")
    answer_all(page)
    page.locator("textarea").first.fill("More <b>lustre</b>")
    assert page.locator("#count").inner_text() == "12 of 12 answered"
    page.locator("#consent").check()
    page.locator("#send").click()
    page.wait_for_selector("#thanks:not([hidden])")
    (answer,) = stored(site)
    assert page.locator("#code").inner_text() == answer.id
    assert {score for _, score in answer.scores} == {4}
    assert answer.suggestions == (("fabric", "More <b>lustre</b>"),)
    assert (answer.exhibit, answer.language) == ("pibo", "en")
    page.locator("details.withdraw summary").click()
    page.locator("#withdraw-code").fill(answer.id)
    page.locator("#withdraw button").click()
    page.get_by_text("Withdrawn.").wait_for()
    assert stored(site) == []


ODD_KEYS = ("constructor", "length", "item", "hidden", "inert", "elements", "submit", "reset")


@pytest.mark.nightly
def test_items_may_be_called_as_the_page_s_own_properties_are(visit, site):
    def text(words):
        return f'{{ zh = "{words}", en = "{words}" }}'

    def part(table, key, named):
        return f'[[{table}]]\nid = "{key}"\n{named} = {text(key)}\n'

    head = 'id = "odd"\nversion = 1\n' + "".join(
        f"{key} = {text(key)}\n" for key in ("title", "intro", "consent")
    )
    scale = f"[scale]\nanchors = [{', '.join([text('point')] * 3)}]\n"
    module = part("module", "constructor", "title") + f"suggestion = {text('more')}\n"
    items = "".join(part("module.item", key, "label") for key in ODD_KEYS)
    (site[1].questionnaires.folder / "odd.toml").write_text(head + scale + module + items, "utf-8")
    end = time.monotonic() + 30
    while site[1].questionnaires.get("odd") is None:  # until a new file shows
        assert time.monotonic() < end
        time.sleep(0.05)
    page = visit("/questionnaires/odd?lang=en")
    assert page.locator("#count").inner_text() == f"0 of {len(ODD_KEYS)} answered"
    assert page.locator("textarea").input_value() == ""
    page.locator("#send").click()
    assert page.locator("#errors li").count() == len(ODD_KEYS) + 1  # all of them, and the consent
    answer_all(page, 2)
    page.reload()
    assert page.locator("input:checked").count() == len(ODD_KEYS)
    page.locator("#consent").check()
    page.locator("#send").click()
    page.wait_for_selector("#thanks:not([hidden])")
    (answer,) = stored(site, "odd")
    assert dict(answer.scores) == dict.fromkeys(ODD_KEYS, 2)


@pytest.mark.nightly
def test_going_back_to_a_sent_form_finds_it_empty(visit, site):
    page = visit("/questionnaires/garment?lang=en")
    form = page.url
    answer_all(page)
    page.locator("#consent").check()
    page.locator("#send").click()
    page.wait_for_selector("#thanks:not([hidden])")
    page.goto(form.replace("/garment", ""))
    page.go_back()
    page.wait_for_timeout(500)  # a browser puts a form's old state back after the page's scripts have run
    # Either the thanks are still there, or a fresh form: never the sent answers, ready to be sent as another's.
    assert page.locator("#thanks").is_visible() or page.locator("input:checked").count() == 0
    assert len(stored(site)) == 1


@pytest.mark.nightly
def test_an_answer_fixed_for_evaluation_is_told_to_stay(visit, site):
    page = visit("/questionnaires/garment?lang=en")
    answer_all(page)
    page.locator("#consent").check()
    page.locator("#send").click()
    page.wait_for_selector("#thanks:not([hidden])")
    site[1].store.freeze("garment")
    page.locator("details.withdraw summary").click()
    page.locator("#withdraw-code").fill(page.locator("#code").inner_text())
    page.locator("#withdraw button").click()
    page.get_by_text("can no longer be withdrawn").wait_for()
    assert len(stored(site)) == 1


def test_what_is_lacking_is_listed_and_reached_by_keyboard_alone(visit, site):
    page = visit("/questionnaires/platform-user?lang=zh")
    page.locator("#send").focus()
    page.keyboard.press("Enter")
    assert page.locator("#errors a").count() == 31  # 30 items and the consent
    for left in range(30, 0, -1):
        page.locator("#errors a").nth(30 - left).focus()
        page.keyboard.press("Enter")
        page.keyboard.press("Space")
        page.keyboard.press("ArrowRight")
    page.locator("#consent").focus()
    page.keyboard.press("Space")
    assert page.locator("#errors").is_hidden()
    page.locator("#send").focus()
    page.keyboard.press("Enter")
    page.wait_for_selector("#thanks:not([hidden])")
    (answer,) = stored(site, "platform-user")
    assert {score for _, score in answer.scores} == {2}


def test_a_reload_and_another_language_keep_what_was_chosen(visit, site):
    page = visit("/questionnaires/garment?lang=zh")
    answer_all(page, 2)
    page.locator("textarea").nth(1).fill("下摆")
    page.locator("#switch").click()
    page.get_by_text("12 of 12 answered").wait_for()
    assert page.locator("textarea").nth(1).input_value() == "下摆"
    page.reload()
    assert page.locator("#restored").is_visible()
    assert page.locator('input[name="score-pleat"][value="2"]').is_checked()
    page.locator("#restart").click()
    assert page.locator("input:checked").count() == 0
    page.reload()
    assert page.locator("input:checked").count() == 0


@pytest.mark.nightly
def test_a_lost_receipt_is_retried_under_the_same_id(visit, site):
    page = visit("/questionnaires/garment?lang=en")
    answer_all(page)
    page.locator("#consent").check()
    tries = []

    def lose_the_receipt(route):
        tries.append(route.request.post_data_json["id"])
        if len(tries) == 1:
            route.fetch()  # the server commits, the visitor never hears of it
            route.abort("connectionreset")
        else:
            route.continue_()

    page.route("**/submissions", lose_the_receipt)
    page.locator("#send").click()
    page.get_by_text("There is no connection.").wait_for()
    page.locator("#state button").first.click()
    page.wait_for_selector("#thanks:not([hidden])")
    assert len(tries) == 2
    assert len(set(tries)) == 1
    assert [answer.id for answer in stored(site)] == tries[:1]


@pytest.mark.nightly
def test_an_answer_on_its_way_survives_closing_the_page(visit, site):
    page = visit("/questionnaires/garment?lang=en")
    answer_all(page)
    page.locator("#consent").check()
    page.route("**/submissions", lambda route: route.abort("internetdisconnected"))
    page.locator("#send").click()
    page.get_by_text("There is no connection.").wait_for()
    assert stored(site) == []
    page.unroute("**/submissions")
    page.reload()
    page.wait_for_selector("#thanks:not([hidden])")
    assert len(stored(site)) == 1


@pytest.mark.nightly
def test_editing_after_a_lost_receipt_does_not_make_a_second_answer(visit, site):
    page = visit("/questionnaires/garment?lang=en")
    answer_all(page)
    page.locator("#consent").check()

    def lose_the_receipt(route):
        route.fetch()
        route.abort("connectionreset")

    page.route("**/submissions", lose_the_receipt, times=1)
    page.locator("#send").click()
    page.get_by_text("Back to my answers").click()
    page.locator(".item").first.locator("label.point").first.click()
    page.locator("#send").click()
    page.get_by_text("the first ones received count").wait_for()
    (answer,) = stored(site)
    assert {score for _, score in answer.scores} == {4}


@pytest.mark.nightly
@pytest.mark.parametrize(
    "told", by_day([False], [True, False]), ids=["the other tab hears of it", "it was asleep"]
)
def test_a_draft_that_another_tab_has_sent_is_not_kept_again(visit, site, told):
    first = visit("/questionnaires/garment?lang=en")
    answer_all(first)
    second = first.context.new_page()
    if not told:
        second.add_init_script(
            "addEventListener('storage', (event) => event.stopImmediatePropagation(), true)"
        )
    second.goto(first.url)
    assert second.locator("#restored").is_visible()
    second.locator("#consent").check()
    first.locator("#consent").check()
    first.locator("#send").click()
    first.wait_for_selector("#thanks:not([hidden])")
    code = first.locator("#code").text_content()
    if not told:
        second.locator(".item").first.locator("label.point").nth(1).click()
    second.get_by_text("sent from another tab").wait_for()
    assert second.locator("input:checked").count() == 0
    left = second.evaluate("JSON.stringify(localStorage)")
    assert code not in left  # whoever has it can withdraw the answer
    assert "scores" not in left
    # What is chosen from now on is an answer of its own, kept as any other.
    answer_all(second, point=2)
    second.reload()
    assert second.locator("#restored").is_visible()
    second.locator("#consent").check()
    second.locator("#send").click()
    second.wait_for_selector("#thanks:not([hidden])")
    assert len({code, second.locator("#code").text_content()}) == 2
    assert sorted(min(score for _, score in answer.scores if score) for answer in stored(site)) == [2, 4]


@pytest.mark.nightly
def test_two_tabs_that_send_the_same_draft_at_once_make_one_answer(visit, site):
    first = visit("/questionnaires/garment?lang=en")
    answer_all(first)
    first.locator("#consent").check()
    first.route("**/submissions", lambda route: route.abort("internetdisconnected"))
    first.locator("#send").click()
    first.get_by_text("There is no connection.").wait_for()
    second = first.context.new_page()
    second.goto(first.url)  # takes up what waits to be sent
    second.wait_for_selector("#thanks:not([hidden])")
    first.get_by_text("Back to my answers").click()
    first.get_by_text("sent from another tab").wait_for()
    assert first.locator("input:checked").count() == 0
    first.reload()
    assert not first.locator("#restored").is_visible()
    assert len(stored(site)) == 1


@pytest.mark.nightly
def test_the_hall_hears_of_an_answer_given_in_its_dialog(visit, site):
    page = visit("/hall")
    frame = page.frame_locator("iframe")
    for item in frame.locator(".item").all():
        item.locator("label.point").nth(5).click()
    frame.locator("#consent").check()
    frame.locator("#consent").press("Escape")
    page.wait_for_function("heard.length === 1")
    frame.locator("#send").click()
    page.wait_for_function("heard.length === 2")
    assert page.evaluate("heard") == [
        {"type": "survey-escape", "id": "garment"},
        {"type": "survey-submitted", "id": "garment"},
    ]
    (answer,) = stored(site)
    assert answer.exhibit == "pibo"
    assert {score for _, score in answer.scores} == {None}


@pytest.mark.nightly
def test_a_network_that_drops_in_the_middle_costs_nothing(visit, site):
    page = visit("/questionnaires/garment?lang=en", width=390, height=844, has_touch=True)
    items = page.locator(".item").all()
    for item in items[:6]:
        item.locator("label.point").nth(2).tap()
    page.context.set_offline(True)
    for item in items[6:]:
        item.locator("label.point").nth(2).tap()
    page.locator("#consent").tap()
    tries = []
    page.on(
        "request", lambda request: request.method == "POST" and tries.append(request.post_data_json["id"])
    )
    page.locator("#send").tap()
    page.get_by_text("There is no connection.").wait_for()
    assert stored(site) == []
    page.context.set_offline(False)  # the page hears of it and sends at once
    page.wait_for_selector("#thanks:not([hidden])")
    (answer,) = stored(site)
    assert page.locator("#code").inner_text() == answer.id
    assert set(tries) == {answer.id}
    assert len(tries) >= 2


@pytest.mark.nightly
def test_items_on_motion_stand_beside_the_film_of_the_exhibit(visit):
    page = visit("/questionnaires/garment?lang=en&exhibit=pibo")
    film = page.locator("section:has(#item-dynamic_swing) video")
    assert page.locator("video").count() == film.count() == 1
    assert film.get_attribute("aria-label") == "The scarf falls"
    page.wait_for_function("document.querySelector('video').readyState >= 1")
    assert page.evaluate("document.querySelector('video').error") is None
    assert visit("/questionnaires/garment?lang=en&exhibit=mirror").locator("video").count() == 0


@pytest.mark.nightly
def test_a_preview_keeps_and_sends_nothing(visit, site):
    page = visit("/questionnaires/garment?lang=en&preview")
    answer_all(page)
    page.locator("#consent").check()
    page.locator("#send").click()
    page.get_by_text("Nothing was sent.").wait_for()
    page.locator("#switch").click()
    page.locator("#preview").wait_for()
    assert page.evaluate("localStorage.length") == 0
    assert stored(site) == []


@pytest.mark.parametrize("language", ["zh", "en"])
@pytest.mark.parametrize("width", by_day([320], [320, 390, 800, 1280]))
def test_nothing_overflows_and_every_target_is_large_enough_for_a_thumb(visit, width, language):
    page = visit(
        f"/questionnaires/platform-user?lang={language}", width=width, height=844, has_touch=width < 500
    )
    page.locator("#send").click()
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    small = page.evaluate("""() => [...document.querySelectorAll("a, button, label.point, textarea, summary, .check")]
        .filter((one) => one.checkVisibility())
        .map((one) => [one.textContent.trim().slice(0, 20), one.getBoundingClientRect()])
        .filter(([, box]) => box.height < 44 || box.width < 44).map(([text, box]) => [text, box.width, box.height])""")
    assert small == []
    clipped = page.evaluate("""() => [...document.querySelectorAll(".cell")]
        .filter((one) => one.scrollWidth > one.clientWidth + 1).map((one) => one.textContent)""")
    assert clipped == []


# Words, by a pattern, of the elements a selector finds that stand on more than one line.
BROKEN = """([selector, pattern]) => [...document.querySelectorAll(selector)].filter((one) => one.checkVisibility())
    .flatMap((one) => {
        const texts = document.createTreeWalker(one, NodeFilter.SHOW_TEXT), found = [];
        while (texts.nextNode()) for (const word of texts.currentNode.data.matchAll(new RegExp(pattern, "g"))) {
            const range = document.createRange();
            range.setStart(texts.currentNode, word.index);
            range.setEnd(texts.currentNode, word.index + word[0].length);
            if (new Set([...range.getClientRects()].map((box) => box.top)).size > 1) found.push(word[0]);
        }
        return found;
    })"""

# Buttons whose words reach beyond their frame.
SPILT = """() => [...document.querySelectorAll("button")].filter((one) => one.checkVisibility())
    .filter((one) => one.scrollWidth > one.clientWidth).map((one) => one.textContent)"""

TAKEN_BACK = (204, {"zh": "已撤回", "en": "are deleted."})


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("status", "told"),
    by_day(
        [TAKEN_BACK],
        [
            TAKEN_BACK,
            (202, {"zh": "残留数据将很快清除", "en": "the last traces of them"}),
            (404, {"zh": "没有找到", "en": "not known"}),
            (409, {"zh": "不能再撤回", "en": "can no longer be withdrawn"}),
            (503, {"zh": "稍后再试", "en": "try again later"}),
        ],
    ),
)
@pytest.mark.parametrize("language", by_day(["zh"], ["zh", "en"]))
def test_every_reply_to_a_withdrawal_is_told_and_its_button_stands_on_one_line(visit, status, told, language):
    page = visit(f"/questionnaires/garment?lang={language}", width=390)
    page.route("**/submissions/**", lambda route: route.fulfill(status=status))
    page.locator("details.withdraw summary").click()
    for width in (390, 1100):
        page.set_viewport_size({"width": width, "height": 800})
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.evaluate(BROKEN, ["button", r"\S+"]) == []
        assert page.evaluate(SPILT) == []
    page.locator("#withdraw-code").fill("01234567-89ab-4def-8123-456789abcdef")
    page.locator("#withdraw button").click()
    page.get_by_text(told[language]).wait_for()


@pytest.mark.nightly
@pytest.mark.parametrize("language", ["zh", "en"])
@pytest.mark.parametrize("width", by_day([320], [320, 390, 1100]))
def test_the_record_of_processing_fits_and_breaks_no_word(visit, width, language):
    page = visit(f"/privacy?lang={language}", width=width)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert page.evaluate(BROKEN, ["h1, h2, th, td, dt", "[A-Za-z]+"]) == []
