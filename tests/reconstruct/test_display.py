"""Progress, on a terminal and in a log."""

import io

from rich.console import Console

from industnerf.reconstruct import display
from industnerf.reconstruct.display import Display


def printed_output(monkeypatch, *, terminal):
    """What two levels print when every step takes three seconds."""
    clock = iter(range(0, 3000, 3))
    monkeypatch.setattr(display.time, "monotonic", lambda: float(next(clock)))
    file = io.StringIO()
    console = Console(file=file, force_terminal=terminal, width=100, color_system=None)
    with Display(console) as bars:
        bars.count_images(1, 2)
        bars.count_images(2, 2)
        bars.start_level("coarse", 10)
        for step in range(10):
            bars.advance(1 / (step + 1))
        bars.log("a [bracket] is kept")
    return file.getvalue()


def test_a_log_gets_a_line_now_and_then(monkeypatch):
    lines = printed_output(monkeypatch, terminal=False).splitlines()
    # The clock is read once at the start, at each level's start and at each step, 3 s apart: the
    # second step of the second level comes at 18 s, 12 s after nothing was said.
    assert lines[-1] == "a [bracket] is kept"
    assert all(line.startswith("coarse: ") for line in lines[:-1])
    assert 1 < len(lines) < 6
    step, left = lines[-2].split(", ")[0], lines[-2].split(", ")[2]
    done = int(step.split()[1])
    assert left == f"{3 * (10 - done)} s left"


def test_a_terminal_gets_bars(monkeypatch):
    text = printed_output(monkeypatch, terminal=True)
    for word in ("photographs", "2/2", "coarse", "10/10", "loss 0.1", "a [bracket] is kept"):
        assert word in text
