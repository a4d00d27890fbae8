"""Progress, on a terminal and in a log."""

import io

from rich.console import Console

from industnerf.reconstruct import display
from industnerf.reconstruct.display import Display

FIRST_S, STEP_S = 60.0, 3.0  # the first step of a level compiles


def printed_output(monkeypatch, *, terminal, steps=40):
    """What two levels print, on a clock that every step moves on."""
    seconds = [0.0]
    monkeypatch.setattr(display.time, "monotonic", lambda: seconds[0])
    file = io.StringIO()
    console = Console(file=file, force_terminal=terminal, width=100, color_system=None)
    with Display(console) as bars:
        bars.count_images(1, 2)
        bars.count_images(2, 2)
        bars.start_level("coarse", steps)
        for step in range(steps):
            seconds[0] += STEP_S if step else FIRST_S
            bars.advance(1 / (step + 1))
        bars.log("a [bracket] is kept")
    return file.getvalue()


def test_a_log_gets_a_line_now_and_then(monkeypatch):
    lines = printed_output(monkeypatch, terminal=False).splitlines()
    assert lines[-1] == "a [bracket] is kept"
    assert all(line.startswith("coarse: ") for line in lines[:-1])
    # one at the first step, then one every fourth, 12 s after nothing was said
    done = [int(line.split()[1]) for line in lines[:-1]]
    assert done == list(range(1, 41, 4))


def test_the_time_that_is_left_is_measured_or_not_said(monkeypatch):
    """Nothing of it is by the first step, which would make it 40 minutes."""
    lines = printed_output(monkeypatch, terminal=False).splitlines()[:-1]
    left = {int(line.split()[1]): line.split(", ")[2:] for line in lines}
    assert left[1] == left[5] == left[9] == []
    assert left[13] == ["81 s left"]  # 27 steps of 3 s
    assert all(left[done] == [f"{STEP_S * (40 - done):.0f} s left"] for done in range(13, 41, 4))


def test_a_terminal_gets_bars(monkeypatch):
    text = printed_output(monkeypatch, terminal=True)
    for word in ("photographs", "2/2", "coarse", "40/40", "loss 0.025", "a [bracket] is kept"):
        assert word in text
