"""`hall` itself: --debug on either side, Ctrl-C at any time, progress in words, work beside the event loop."""

from __future__ import annotations

import asyncio
import io
import threading
import tomllib
from pathlib import Path

import event_loop
import pytest

from hall_app import cli
from hall_app.house import in_thread
from hall_app.web import OFFERS, ProgressLine

ORDERS = (["--debug", "check", "x"], ["check", "--debug", "x"], ["check", "x", "--debug"])


def broken(*arguments: object) -> None:
    raise ZeroDivisionError("of the test")


@pytest.mark.parametrize("words", ORDERS)
def test_debug_stands_before_or_behind_the_command(words: list[str], monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("hall_app.check.command.content_folder", broken)
    with pytest.raises(ZeroDivisionError):
        cli.main(words)


def test_without_debug_an_error_is_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr("hall_app.check.command.content_folder", broken)
    assert cli.main(["check", "x"]) == 1
    assert capsys.readouterr().err == "hall check: of the test\n"


@pytest.mark.parametrize("command", ["serve", "build", "check", "bench"])
def test_every_command_takes_debug(command: str):
    assert cli._parser().parse_args([command, "--debug"]).debug is True
    assert cli._parser().parse_args([command]).debug is False


def test_the_quota_is_two_gigabytes_and_help_says_of_what(capsys: pytest.CaptureFixture[str]):
    assert cli._parser().parse_args(["serve"]).quota == 2
    with pytest.raises(SystemExit):
        cli.main(["serve", "--help"])
    told = " ".join(capsys.readouterr().out.split())
    assert "(default 2); backups, restored houses and bakes are not counted" in told


def test_the_hall_offers_every_page_that_its_questionnaires_ask_about():
    needed = set()
    for path in (Path(__file__).parents[2] / "assets/questionnaires").glob("*.toml"):
        told = tomllib.loads(path.read_text("utf-8"))
        needed |= {module["needs"] for module in told["module"] if "needs" in module}
    assert "office" in needed
    assert needed <= OFFERS


def test_ctrl_c_while_the_program_is_loaded(monkeypatch: pytest.MonkeyPatch):
    def interrupted() -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "_parser", interrupted)
    assert cli.main(["check"]) == 130


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_progress_in_a_log_is_a_line_now_and_then():
    log, now = io.StringIO(), [0.0]
    line = ProgressLine(log, clock=lambda: now[0])
    for tick in range(100):
        now[0] = 0.3 * tick
        line.tell(f"Preparing {tick} %  ")
    line.tell("Preparing: done", done=True)
    line.end()
    said = log.getvalue().splitlines()
    assert said[0] == "Preparing 0 %"
    assert said[-1] == "Preparing: done"
    assert len(said) == 1 + 5 + 1  # 30 s
    assert "\r" not in log.getvalue()


def test_a_log_does_not_repeat_itself():
    log, now = io.StringIO(), [0.0]
    line = ProgressLine(log, clock=lambda: now[0])
    for tick in range(100):
        now[0] = tick
        line.tell("Preparing 0 %" if tick < 90 else "Preparing 1 %")
    assert log.getvalue().splitlines() == ["Preparing 0 %", "Preparing 1 %"]


def test_the_next_step_is_told_at_once():
    log = io.StringIO()
    line = ProgressLine(log, clock=lambda: 0.0)
    for text, done in (("one 1 %", False), ("one 9 %", False), ("one: done", True), ("two 1 %", False)):
        line.tell(text, done=done)
    assert log.getvalue().splitlines() == ["one 1 %", "one: done", "two 1 %"]


def test_progress_on_a_terminal_is_written_over():
    screen = Terminal()
    line = ProgressLine(screen)
    line.tell("a long word " * 30)
    line.tell("short")
    line.end()
    first, second = screen.getvalue().split("\r")[1:]
    assert len(first) == len(second.rstrip("\n"))
    assert second.rstrip() == "short"
    assert second.endswith("\n")
    line.tell("done", done=True)
    line.end()
    assert screen.getvalue().count("\n") == 2


def test_work_beside_the_loop_gives_and_raises():
    async def both() -> int:
        with pytest.raises(ZeroDivisionError):
            await in_thread(broken)
        return await in_thread(divmod, 7, 2)

    assert event_loop.run(both()) == (3, 1)


def test_work_beside_the_loop_does_not_keep_it_from_ending():
    go, ended = threading.Event(), threading.Event()

    def slow() -> None:
        go.wait(30)
        ended.set()

    async def impatient() -> None:
        with pytest.raises(asyncio.TimeoutError):
            await asyncio.wait_for(in_thread(slow), 0.05)

    event_loop.run(impatient())
    assert not ended.is_set()
    go.set()
    assert ended.wait(30)
