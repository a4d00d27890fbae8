"""SIGKILL at random moments of a smoke run."""

import os
import random
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.campaign.conftest import WorkingCopy

pytestmark = pytest.mark.campaign

KILLS = int(os.environ.get("CAMPAIGN_KILLS", "50"))
SECONDS = (0.5, 30.0)  # between the start and the kill


def test_a_run_that_was_killed_ends_with_the_same_bytes(
    root: Path, tmp_path: Path, print_row: Callable[[str], None]
):
    undisturbed = WorkingCopy(root, tmp_path / "undisturbed", "smoke")
    assert undisturbed.start().wait() == 0, undisturbed.log()[-2000:]
    expected, moments = undisturbed.outputs(), random.Random(50)
    kills, num_torn, copies = 0, 0, 0
    while kills < KILLS:
        copies += 1
        copy = WorkingCopy(root, tmp_path / f"killed-{copies}", "smoke")
        while kills < KILLS and (code := copy.kill_after(moments.uniform(*SECONDS))) is None:
            kills += 1
        if kills == KILLS:
            code = copy.start().wait()
        num_torn += copy.log().count("It is set aside")
        assert code == 0, copy.log()[-3000:]
        outputs = copy.outputs()
        assert sorted(outputs) == sorted(expected)
        assert [name for name in expected if outputs[name] != expected[name]] == []
        assert copy.log().count("damaged result") == 0
        code, text = copy.doctor()
        assert code == 0, text
        print_row(
            f"{kills} kills, {copies} runs, {num_torn} torn locks mended, {len(expected)} files"
        )
