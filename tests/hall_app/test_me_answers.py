"""Withdrawal codes in an account: kept for who asks in so many words, listed, used, forgotten, in the copy, deleted."""

from __future__ import annotations

import io
import json
import re
import uuid
import zipfile

import pytest
from form_visitor import Visitor
from open_counter import ASKED, SAID, answered
from test_me import PASSWORD, member

from hall_app.house.people.records import MOST_CODES
from survey.web.form import form_page

NEW = "/me/answers/new?lang=en"


def stored(counter) -> set[str]:
    """Codes of all answers that stand."""
    survey = counter.house.survey_answers
    return {row.answer.id for row in survey.store.rows(ASKED)}


def keep(visitor: Visitor, code: str):
    return visitor.send(NEW, "form-keep-code", code=code, consent="on")


def test_a_code_is_kept_only_for_who_ticks_the_box(counter):
    (visitor, _), code = member(counter), answered(counter)
    assert code not in visitor.get("/me?lang=en").text
    page = visitor.get(NEW)
    assert "consent" not in page.form("form-keep-code"), "nobody has ticked the box beforehand"
    assert "links the account to these answers" in page.text
    unasked = visitor.send(page, "form-keep-code", code=code)
    assert unasked.status == 400
    assert 'role="alert">Tick the box first' in unasked.text
    assert unasked.form("form-keep-code")["code"] == code, "what was typed stands there again"
    assert code not in visitor.get("/me?lang=en").text
    kept = keep(visitor, code.upper())
    assert "The account keeps the code" in kept.text
    listed = visitor.get("/me?lang=en").text
    assert code in listed
    assert ASKED.title.en in listed
    other = member(counter)[0]
    assert code not in other.get("/me?lang=en").text
    assert other.send(kept, "/me/answers/forget").status == 403, "a form of another's session"


def test_the_thanks_hand_the_code_over_and_nothing_is_kept_yet(counter):
    """As the page of the questionnaire does it: by POST, in no address, without a seal and without an Origin."""
    (visitor, _), code = member(counter), answered(counter)
    page = form_page(ASKED, "en", None, keep="/me/answers/new")
    assert re.search(r'<form method="post" action="/me/answers/new" target="_blank"', page)
    sent = {"Content-Type": "application/x-www-form-urlencoded", "Origin": "null"}
    handed = visitor.ask("POST", "/me/answers/new", f"code={code}&lang=en".encode(), sent)
    assert handed.status == 200
    assert handed.form("form-keep-code")["code"] == code
    assert code not in visitor.get("/me?lang=en").text, "it was shown and not kept"
    assert "The account keeps the code" in visitor.send(handed, "form-keep-code", consent="on").text
    stranger = Visitor(counter.url).ask("POST", "/me/answers/new", f"code={code}&lang=zh".encode(), sent)
    assert stranger.status == 200
    assert "请先登录" in stranger.text
    assert code not in stranger.text
    large = visitor.ask("POST", "/me/answers/new", b"code=" + b"0" * 30_000, sent)
    assert large.status == 413
    hostile = visitor.ask("POST", "/me/answers/new", b"code=%22%3E%3Cscript%3E&lang=en", sent)
    assert "<script" not in hostile.text


def test_no_questionnaire_offers_it_where_there_are_no_accounts():
    assert "keep-code" not in form_page(ASKED, "en", None)


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("0000", "no withdrawal code"),
        (str(uuid.UUID(int=0)), "no withdrawal code"),
        ("f8295b3e-ace8-4d90-bd25-fc1f2e6684a2", "no answers"),
    ],
)
def test_what_is_no_code_of_an_answer_is_not_kept(counter, code, said):
    visitor = member(counter)[0]
    refused = keep(visitor, code)
    assert refused.status == 400
    assert said in refused.text


def test_answers_are_withdrawn_by_the_code(counter):
    (visitor, _), code, other = member(counter), answered(counter), answered(counter)
    keep(visitor, code)
    told = visitor.send("/me?lang=en", "/me/answers/withdraw", found={"code": code})
    assert "Withdrawn. The ratings and suggestions are deleted" in told.text
    assert code not in told.text
    assert other in stored(counter)
    assert code not in stored(counter)
    again = keep(visitor, code)
    assert again.status == 400
    assert "withdrawn already" in again.text


def test_nobody_withdraws_by_a_code_his_account_does_not_keep(counter):
    (visitor, _), mine, theirs = member(counter), answered(counter), answered(counter)
    keep(visitor, mine)
    given = visitor.get("/me").form("/me/answers/withdraw", code=mine)
    for act in ("withdraw", "forget"):
        assert visitor.post(f"/me/answers/{act}", given | {"code": theirs}).status == 400
    assert {mine, theirs} <= stored(counter)
    stranger = Visitor(counter.url).post("/me/answers/withdraw", given)
    assert stranger.status in (303, 403)
    assert mine in stored(counter)


def test_a_code_is_forgotten_and_the_answers_stay(counter):
    (visitor, _), code = member(counter), answered(counter)
    keep(visitor, code)
    told = visitor.send("/me?lang=en", "/me/answers/forget", found={"code": code})
    assert "has forgotten the code" in told.text
    assert code not in told.text
    assert code in stored(counter)
    files = b"".join(file.read_bytes() for file in counter.data.glob("people.sqlite*"))
    assert code.encode() not in files, "nor does a file hold it any more"


def test_what_was_withdrawn_or_fixed_elsewhere_is_told(counter):
    (visitor, _), gone, fixed = member(counter), answered(counter), answered(counter)
    keep(visitor, gone)
    keep(visitor, fixed)
    visitor.ask("DELETE", f"/api/v1/questionnaires/{ASKED.id}/submissions/{gone}")
    before = visitor.get("/me?lang=en")
    counter.house.survey_answers.store.freeze(ASKED.id)
    late = visitor.send(before, "/me/answers/withdraw", found={"code": fixed})
    assert late.status == 400
    assert "fixed for evaluation" in late.text
    listed = visitor.get("/me?lang=en")
    assert re.search(f"{gone}.*?withdrawn</span>", listed.text, re.DOTALL)
    assert re.search(f"{fixed}.*?can no longer be withdrawn</span>", listed.text, re.DOTALL)
    for code in (gone, fixed):
        visitor.send("/me?lang=en", "/me/answers/forget", found={"code": code})
    assert fixed in stored(counter)


def test_a_code_is_in_the_copy_and_goes_with_the_account(counter):
    (visitor, _), code = member(counter), answered(counter)
    assert "Withdrawal codes" not in visitor.get("/me/delete?lang=en").text
    keep(visitor, code)
    copy = visitor.send("/me", "/me/copy")
    with zipfile.ZipFile(io.BytesIO(copy.body)) as archive:
        assert [one["code"] for one in json.loads(archive.read("answers.json"))] == [code]
        assert "withdrawal codes" in archive.read("README.txt").decode()
        assert SAID not in "".join(archive.read(name).decode() for name in archive.namelist())
    page = visitor.get("/me/delete?lang=en")
    assert "go with it (1). Those answers stay" in page.text
    assert "The account is deleted" in visitor.send(page, "form-delete", password=PASSWORD).text
    assert code in stored(counter), "the answers are nobody's now, and stay"
    files = b"".join(file.read_bytes() for file in counter.data.glob("people.sqlite*"))
    assert code.encode() not in files


def test_the_journal_and_the_office_tell_no_code(counter):
    (visitor, address), code = member(counter), answered(counter)
    keep(visitor, code)
    people = counter.people
    person = people.accounts.find(address=address)
    told = people.journal.about(person.id)
    assert told[-1].act == "answer codes"
    assert code not in "".join(entry.subject for entry in told)


def test_there_is_a_limit(counter):
    visitor, address = member(counter)
    person = counter.people.accounts.find(address=address)
    for _ in range(MOST_CODES):
        counter.people.answer_codes.keep(person.id, str(uuid.uuid4()))
    full = keep(visitor, answered(counter))
    assert full.status == 400
    assert f"keeps {MOST_CODES} codes" in full.text
    assert visitor.get("/me?lang=en").text.count("the house has no answers of this code") == MOST_CODES


@pytest.mark.parametrize("lang", ["zh", "en"])
def test_pages_are_in_one_language(counter, lang):
    (visitor, _), code = member(counter, lang), answered(counter)
    keep(visitor, code)
    for path in ("/me", "/me/answers/new", "/me/delete"):
        main = visitor.get(f"{path}?lang={lang}").text.partition("<main")[2].partition("</main>")[0]
        words = re.sub(r"<[^>]*>", " ", main).replace("中文", "")
        assert bool(re.search("[\u4e00-\u9fff]", words)) == (lang == "zh"), path
    told = Visitor(counter.url).get(f"/me/privacy?lang={lang}").text
    assert ("由账户保管" if lang == "zh" else "ask that the account keep it") in told
