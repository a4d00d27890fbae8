"""What a stage says of itself, with a terminal and without."""

from rich.console import Console

from industnerf import progress
from industnerf.progress import Progress
from industnerf.store import Cost

PENDING = [("hull", "gear"), ("hull", "screw"), ("nerf", "gear")]


def cost(seconds: float) -> Cost:
    return Cost(2 * seconds, 90.0, "cpu", cpu_seconds=seconds, extra_cpu_seconds=0.5)


def test_each_method_says_what_it_took_and_the_stage_what_all_did(capsys):
    with Progress("reconstruct", PENDING, reused=4, workers=2) as shown:
        shown.advance(1, None, cost(2.0))
        shown.advance(0, None, cost(3.0))
        shown.advance(2, "no surface", None)
    lines = capsys.readouterr().out.splitlines()
    assert lines[:3] == [
        "reconstruct hull: screw, 2.5 processor s, 1 of 3",
        "reconstruct hull: gear, 3.5 processor s, 2 of 3",
        "reconstruct hull: 2 made, 6.0 processor s, at most 90 MB a process",
    ]
    assert "reconstruct nerf: gear failed: no surface" in lines
    assert lines[-1].startswith("reconstruct: done, 2 made, 4 reused, 1 failed, ")
    assert lines[-1].endswith(" s, 6.0 processor s, at most 90 MB a process")


def test_a_stage_with_nothing_to_do_says_nothing(capsys):
    with Progress("procedural", [], reused=0, workers=2):
        pass
    assert capsys.readouterr().out == ""


def test_without_a_terminal_few_parts_are_named_but_none_after_a_long_silence_is_left_out(
    capsys, monkeypatch
):
    pending = [("", f"p{i}") for i in range(50)]
    with Progress("views", pending, reused=0, workers=1) as shown:
        for i in range(49):
            shown.advance(i, None, cost(1.0))
        named = capsys.readouterr().out.count("processor s")
        monkeypatch.setattr(progress, "MAX_SILENCE_S", 0.0)
        shown.advance(49, None, cost(1.0))
    assert named == 4
    assert "views: p49" in capsys.readouterr().out


def test_a_terminal_shows_what_every_worker_is_at(monkeypatch):
    console = Console(force_terminal=True, record=True, width=100)
    monkeypatch.setattr(progress, "Console", lambda: console)
    with Progress("reconstruct", PENDING, reused=0, workers=2) as shown:
        assert running(shown) == ["  hull gear", "  nerf gear"]
        shown.advance(0, None, cost(1.0))
        assert running(shown) == ["  nerf gear", "  hull screw"]
        shown.advance(1, None, cost(1.0))
        assert running(shown) == ["  nerf gear"]


def running(shown: Progress) -> list[str]:
    return [task.description for task in shown._bar.tasks if task.id != shown._total]
