"""What `pipeline.sweep` refuses, says and completes before anything is run."""

import os
import subprocess
import sys

import pytest

from industnerf.errors import BadParams
from pipeline.command_line import check_command_line
from tests.conftest import ROOT

HEAVY = ("torch", "mlflow", "scipy", "matplotlib", "trimesh", "ot", "optuna", "pandas")
# Runs pipeline.sweep as __main__, and ends with the names of HEAVY that it has imported.
REPORT_IMPORTS = (
    "import runpy, sys, atexit;"
    f"atexit.register(lambda: print('heavy:', *sorted(set(sys.modules) & set({HEAVY}))));"
    "runpy.run_module('pipeline.sweep', run_name='__main__', alter_sys=True)"
)

TYPOS = {
    "views.cuont=8": "there is no key views.cuont, did you mean `views.count`?",
    "+views.cuont=8": "did you mean `views.count`?",
    "viwes.count=8,9": "did you mean `views.count`?",
    "count=8": "did you mean `views.count`?",
    "hull.pionts=2048": "did you mean `method.hull.points`",
    "method.hul.points=2048": "did you mean `method.hull.points`?",
    "method=[hull]": "method is a section, did you mean `methods`?",
    "views=8": "views is a section with the keys count, held_out",
    "foo=1": "there is no key foo; params.yaml has all that there are",
    "experimnt=four": "did you mean `experiment`?",
    "experiment=fuor": "experiment=fuor is unknown, did you mean `four`? known are ablation, demo",
    "experiment=four,demmo": "did you mean `demo`?",
    "ablation=photohull": "did you mean `photo_hull`?",
    "hydra/sweeper=optna": "did you mean `optuna`?",
    "hydra/sweepr=optuna": "did you mean `hydra/sweeper`?",
    "hydra.sweep.dirr=mine": "did you mean `hydra.sweep.dir`?",
    "hydra.sweeper.params.views.cuont=8": "did you mean `views.count`?",
    "views.count": "'views.count' is no override, which is key=value",
    "methods=[hull": "'methods=[hull' is no override",
    "method.hull.cell_px=interval(0,1)": "needs hydra/sweeper=optuna",
    "--cfg=job": "--cfg prints the values of one point: leave --multirun out",
}


@pytest.mark.parametrize(("argument", "message"), TYPOS.items(), ids=TYPOS)
def test_what_there_is_not_is_refused_with_what_may_be_meant(argument, message):
    with pytest.raises(BadParams) as refusal:
        check_command_line(["--multirun", argument])
    assert message in str(refusal.value)


@pytest.mark.parametrize(
    "arguments",
    [
        ("ablation=glob(*)", "experiment=four"),
        ("views={count: 8}", "~seed"),
        ("hydra.sweep.dir=mine", "hydra.mode=MULTIRUN", "parts.select=[a],[b]"),
        ("hydra/sweeper=optuna", "hydra.sweeper.n_trials=3", "method.hull.cell_px=interval(0,1)"),
        ("experiment=null", "+hydra.job.env_set.OMP_NUM_THREADS=1"),
        ("--help", "views.cuont=8"),
    ],
)
def test_what_there_is_passes(arguments):
    check_command_line(["--multirun", *arguments])


def run_sweep(folder, *arguments: str) -> tuple[int, str, list[str]]:
    """Exit code, output, and what was imported, in a `folder` of its own."""
    environment = {**os.environ, "INDUSTNERF_ROOT": str(ROOT), "INDUSTNERF_MLFLOW": str(folder)}
    environment["PYTHONPATH"] = f"{ROOT / 'src'}:{ROOT}"
    command = [sys.executable, "-c", REPORT_IMPORTS, *arguments]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    imported = [line for line in done.stdout.splitlines() if line.startswith("heavy:")]
    return done.returncode, done.stdout + done.stderr, imported[-1].split()[1:]


REFUSED = {
    "a key": (("views.cuont=8",), "did you mean `views.count`?"),
    "a key of a sweep": (("-m", "views.cuont=8,9"), "did you mean `views.count`?"),
    "a method": (("methods=[hul]",), "methods[0] is 'hul', must be one of"),
    "a method of a sweep": (("-m", "methods=[hul]"), "did you mean `hull`?"),
    "no list": (("-m", "methods=hull"), "methods is 'hull', must be a list: [hull]"),
    "a value": (("-m", "views.fov_deg=150,160"), "views.fov_deg is 160.0, must be in (0, 120)"),
    "a preset": (("-m", "experiment=fuor"), "did you mean `four`?"),
}


@pytest.mark.parametrize(("arguments", "message"), REFUSED.values(), ids=REFUSED)
def test_a_refusal_comes_before_any_heavy_import(arguments, message, tmp_path):
    code, output, imported = run_sweep(tmp_path, *arguments)
    assert (code, imported) == (2, [])
    assert message in output
    assert "Traceback" not in output
    assert not list(tmp_path.glob("*.db"))


@pytest.mark.parametrize(
    ("arguments", "printed"),
    [
        (("--help",), ("Examples", "hydra/sweeper=optuna", "experiment: ablation, demo")),
        (("--cfg", "job", "experiment=four"), ("preset: four", "- clock-wheel-m1-z48")),
    ],
)
def test_questions_are_answered(arguments, printed, tmp_path):
    code, output, imported = run_sweep(tmp_path, *arguments)
    assert (code, imported) == (0, [])
    assert all(text in output for text in printed)


COMPLETE = """source conf/completion.bash
COMP_LINE=$1 COMP_WORDS=($1)
COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
_industnerf
echo "${COMPREPLY[@]}"
"""


@pytest.mark.parametrize(
    ("line", "completions"),
    [
        ("python -m pipeline.sw", {"pipeline.sweep"}),
        ("python -m pipeline.sweep views.cou", {"views.count="}),
        ("python -m pipeline.sweep -m experiment=tw", {"experiment=twenty"}),
        ("python -m pipeline.sweep -m hydra/sweeper=o", {"hydra/sweeper=optuna"}),
        ("python -m pipeline.preset de", {"demo", "dev"}),
        ("python other.py vi", set()),
    ],
)
def test_tab_completes_presets_groups_and_keys(line, completions):
    line = line.replace("python", sys.executable, 1)
    environment = {**os.environ, "PYTHONPATH": f"{ROOT / 'src'}:{ROOT}"}
    done = subprocess.run(
        ["bash", "-c", COMPLETE, "bash", line],
        cwd=ROOT,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert set(done.stdout.split()) == completions
