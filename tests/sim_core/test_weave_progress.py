"""What is told while a relaxation runs."""

import time

from sim_core.weave import plain, relax_particles
from sim_core.weave.progress import shown
from sim_core.weave.words import dressed


def test_stage_steps_and_residual_are_told_on_stderr(capsys):
    with shown("cloth", first=0.01, every=0.01) as watch:
        while "stage A" not in capsys.readouterr().err:
            time.sleep(0.01)
        cell = relax_particles(dressed(plain()), watch=watch)
        while "stage B, step" not in (told := capsys.readouterr().err):
            time.sleep(0.01)
    assert watch[0] == cell.steps
    assert watch[1] == cell.residual
    assert f"cloth: stage B, step {cell.steps}, residual {cell.residual:.1e}" in told


def test_what_is_soon_done_is_not_told(capsys):
    with shown("cloth", first=60):
        pass
    captured = capsys.readouterr()
    assert captured.err == ""
