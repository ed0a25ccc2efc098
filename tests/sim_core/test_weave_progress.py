"""What is told while a relaxation runs."""

from time import monotonic, sleep

from sim_core.weave import plain, relax_particles
from sim_core.weave.files import dressed
from sim_core.weave.yarns import progress_report


def heard(capsys, words: str, patience: float = 60.0) -> bool:
    """Whether it is told, sooner or later."""
    end = monotonic() + patience
    while words not in capsys.readouterr().err:
        if monotonic() > end:
            return False
        sleep(0.01)
    return True


def test_stage_steps_and_residual_are_told_on_stderr(capsys):
    with progress_report("cloth", first=0.01, every=0.01) as watch:
        assert heard(capsys, "stage A")
        cell = relax_particles(dressed(plain()), watch=watch)
        # A slow machine tells steps on the way as well; the last word is the cell's own.
        assert heard(capsys, f"cloth: stage B, step {cell.steps}, residual {cell.residual:.1e}\n")
    assert watch[0] == cell.steps
    assert watch[1] == cell.residual


def test_what_is_soon_done_is_not_told(capsys):
    with progress_report("cloth", first=60):
        pass
    captured = capsys.readouterr()
    assert captured.err == ""
