"""From a finished run to what is committed; and what is committed belongs together."""

import json
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from industnerf.config import load_params
from industnerf.errors import BadArtifact, BadParams
from industnerf.report.docs.markdown_blocks import read_block
from industnerf.report.docs.study_results import readme_block, results_block
from pipeline import publish
from tests.pipeline.conftest import Project
from tests.pipeline.lock_check import lock_mismatches

pytestmark = pytest.mark.slow  # runs whole pipelines

DOCUMENTS = {
    "README.md": ["study"],
    "docs/results/study.md": ["study"],
    "docs/results/claims.md": ["claims"],
    "docs/results.md": ["summary"],
    "docs/reference/baselines.md": ["nets"],
    "docs/reference/scaling.md": ["costs", "cluster"],
    "docs/reference/readings.md": ["measuring"],
    "docs/reference/sweeps.md": ["sweeps"],
}
MARKS = "<!-- study -->\n<!-- end study -->\n"


@pytest.fixture
def project(root, tmp_path):
    """A repository of its own, with nothing run yet."""
    project = Project(root, tmp_path / "project")
    for document, names in DOCUMENTS.items():
        marks = "".join(MARKS.replace("study", name) for name in names)
        (project.folder / document).parent.mkdir(parents=True, exist_ok=True)
        (project.folder / document).write_text(marks)
    (project.folder / ".gitignore").write_text("/.dvc\n/data\n/reports\n__pycache__\n")
    names = ("-c", "user.name=n", "-c", "user.email=e@example.org")
    for command in (["init", "-q"], ["add", "-A"], [*names, "commit", "-q", "-m", "first"]):
        subprocess.run(["git", *command], cwd=project.folder, check=True)
    return project


def copy_run(run, project):
    """What `run` wrote, and DVC's record and copies of it."""
    catalogue = shutil.ignore_patterns(
        "embedded", "organic", "pretrained"
    )  # links, which are there already
    for name in ("data", "reports", ".dvc/cache"):
        folders = run.folder / name, project.folder / name
        shutil.copytree(*folders, ignore=catalogue, dirs_exist_ok=True)
    shutil.copy(run.folder / "dvc.lock", project.folder)


def test_a_study_is_published_when_it_is_finished_and_not_before(project, finished_run):
    code, output = project.run("python", "-m", "pipeline.publish")
    assert code == 2
    assert "the study is not finished: " in output
    assert ": `make repro` goes on" in output
    assert "Traceback" not in output
    out = project.folder / "results" / "study"
    assert not out.exists()

    copy_run(finished_run, project)
    for _ in range(2):  # what the first wrote is no change to the second
        code, output = project.run("python", "-m", "pipeline.publish")
        assert code == 0, output
        provenance = json.loads((out / "made.json").read_text())
        assert (provenance["clean"], provenance["changed"]) == (True, [])
    readme, page = ((project.folder / name).read_text() for name in list(DOCUMENTS)[:2])
    params = project.folder / "params.yaml"
    assert read_block(readme, "study") == readme_block(out, params)
    assert read_block(page, "study") == results_block(out, params, with_paper_tables=True)
    assert "2 test parts of 2 families" in readme
    for name in ("table1.csv", "scores.csv"):
        assert (out / name).read_bytes() == (project.folder / "reports" / name).read_bytes()
    assert lock_mismatches(out, "pipeline") == []

    params.write_text(params.read_text().replace("sheet_parts: ", "sheet_parts: 1"))
    code, output = project.run("python", "-m", "industnerf.report.docs")
    assert code == 0, output
    page = (project.folder / "docs/results/study.md").read_text()
    assert "no longer those of the study" in read_block(page, "study")
    assert lock_mismatches(out, "pipeline") == []


def test_other_parts_do_not_replace_the_study(root, monkeypatch):
    params = load_params(root / "params.yaml")
    for source, path in (("path", "my-parts"), ("embedded", "data/organic")):
        others = replace(params, parts=replace(params.parts, source=source, path=path))
        monkeypatch.setattr(publish, "load_params", lambda others=others: others)
        with pytest.raises(BadParams, match=rf"parts\.path is {path}.*give others a preset"):
            publish.main()


@pytest.fixture
def locked(finished_run, tmp_path):
    """What git has of a finished run."""
    for name in ("dvc.lock", "dvc.yaml", "params.yaml"):
        shutil.copy(finished_run.folder / name, tmp_path / name)
    return tmp_path


def test_the_lock_of_a_run_belongs_to_its_params_and_pipeline(locked):
    assert lock_mismatches(locked) == []


@pytest.mark.parametrize(
    ("file", "old", "new", "mismatch"),
    [
        ("params.yaml", "seed: 0", "seed: 1", "views: ran with seed 0"),
        ("params.yaml", "count: 6", "count: 7", "report: ran with views.count 6"),
        ("params.yaml", "- hull\n", "", "reconstruct: ran with methods"),
        ("params.yaml", "path: data/embedded", "path: mine", "parts: other deps"),
        ("dvc.yaml", "data/views data/truth data/clouds", "data/truth", "evaluate: ran "),
        ("dvc.yaml", "params: [split]", "params: [split, seed]", "split: ran with seed None"),
        ("dvc.yaml", "outs: [data/truth]", "outs: [data/t]", "truth: other outs"),
    ],
)
def test_a_lock_of_something_else_is_found_out(locked, file, old, new, mismatch):
    text = (locked / file).read_text()
    assert old in text
    (locked / file).write_text(text.replace(old, new))
    assert any(line.startswith(mismatch) for line in lock_mismatches(locked))


def test_a_lock_of_two_runs_is_found_out(locked):
    lock = yaml.safe_load((locked / "dvc.lock").read_text())
    for each in lock["stages"]["views"]["deps"]:
        if each["path"] == "data/parts/index.json":
            each["md5"] = "of another run"
    (locked / "dvc.lock").write_text(yaml.safe_dump(lock))
    assert any("another data/parts/index.json" in line for line in lock_mismatches(locked))


def test_the_committed_lock_is_that_of_the_committed_study(root):
    """`make repro` and `make results`, and commit dvc.lock with what they wrote.

    The values of the run are published with it; the page of the study names what changed since.
    """
    study = root / "results" / "study"
    assert lock_mismatches(study, "pipeline") == []
    assert (root / "dvc.lock").read_bytes() == (study / "pipeline.lock").read_bytes()


def test_a_sweep_that_the_documents_cannot_show_leaves_what_is_published(monkeypatch, tmp_path):
    (tmp_path / "sweep.csv").write_text("point,split.hold_out,method,split\n0,none,r2n2,test\n")
    monkeypatch.setattr(publish, "LEAKAGE", tmp_path)
    monkeypatch.setattr(publish, "publish_run", lambda *_: pytest.fail("it was brought"))
    with pytest.raises(BadArtifact, match="has no r2n2 at split"):
        publish.main()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("organic", "runs/organic holds no run: `python -m pipeline.preset organic`"),
        ("grid", "runs/grid holds no run; these do: demo, dev"),
        (
            "seeds",
            "runs/seeds holds no run: `python -m pipeline.sweep experiment=seeds`, which "
            "`python -m pipeline.seed_variance` publishes",
        ),
    ],
)
def test_what_has_not_run_is_told_how_if_it_can(tmp_path, monkeypatch, name, message):
    monkeypatch.chdir(tmp_path)
    for file in ("conf/experiment/organic.yaml", "runs/dev/params.yaml", "runs/demo/params.yaml"):
        Path(file).parent.mkdir(parents=True, exist_ok=True)
        Path(file).touch()
    Path("conf/experiment/organic.yaml").write_text("preset: organic")
    Path("conf/experiment/seeds.yaml").write_text("hydra: {mode: MULTIRUN}")
    Path("runs/grid").mkdir()
    with pytest.raises(BadArtifact) as error:
        publish.main(name)
    assert str(error.value) == message


def test_without_any_run_there_is_none_to_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadArtifact, match="runs/grid holds no run; these do: none"):
        publish.main("grid")
