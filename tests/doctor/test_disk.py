"""Room on the disk, against closed forms."""

import shutil
import sys
from pathlib import Path

import pytest
import yaml

from industnerf.config import load_params
from industnerf.doctor.disk import PER_CLOUD, PER_PART, PER_PIXEL, estimate
from industnerf.store import Cost, Store
from tests.doctor.conftest import WorkingCopy


@pytest.fixture
def study(bare_copy: WorkingCopy, root: Path) -> Path:
    """params.yaml of two parts, ten views of 100 x 100 pixels and three methods."""
    path = bare_copy.folder / "params.yaml"
    values = yaml.safe_load((root / "params.yaml").read_text())
    values["parts"]["select"] = ["a", "b"]
    values["methods"] = ["hull", "box", "oracle"]
    values["views"] |= {"count": 8, "held_out": 2, "resolution": 100}
    path.write_text(yaml.safe_dump(values))
    return path


def test_the_estimate_is_a_sum_over_parts(study: Path):
    one = PER_PART + 10 * 100**2 * PER_PIXEL + 3 * PER_CLOUD
    assert estimate(study.parent, load_params(study)) == 2 * one


def test_without_a_selection_files_are_counted(study: Path, tmp_path: Path):
    text = study.read_text().replace("path: data/embedded", f"path: {tmp_path / 'mine'}")
    text = text.replace("  select:\n  - a\n  - b\n", "  select: []\n")
    (tmp_path / "mine").mkdir()
    for name in "abc":
        (tmp_path / "mine" / f"{name}.stl").touch()
    study.write_text(text)
    one = PER_PART + 10 * 100**2 * PER_PIXEL + 3 * PER_CLOUD
    assert estimate(tmp_path, load_params(study)) == 3 * one


def test_a_single_file_is_one_part(study: Path, tmp_path: Path):
    text = study.read_text().replace("path: data/embedded", f"path: {tmp_path / 'one.stl'}")
    (tmp_path / "one.stl").touch()
    study.write_text(text.replace("  select:\n  - a\n  - b\n", "  select: []\n"))
    one = PER_PART + 10 * 100**2 * PER_PIXEL + 3 * PER_CLOUD
    assert estimate(tmp_path, load_params(study)) == one


def test_what_the_study_has_made_need_not_be_written_again(study: Path, bare_copy: WorkingCopy):
    """Unless it was made of other parameters or by other code, which no index tells."""

    def make(out: Path) -> Cost:
        (out / "pictures").write_bytes(bytes(3_000_000))
        return Cost(1.0, 1.0, "cpu")

    for key in ("k", "of-another-study"):
        Store(bare_copy.paths.store).put("views", key, make)
    views = bare_copy.folder / "data" / "views"
    views.mkdir(parents=True)
    (views / "index.json").write_text('{"schema": 1, "step": "views", "keys": {"a": "k"}}')
    (bare_copy.folder / "data" / "index.json").write_text('{"sch')
    findings = bare_copy.check("disk")
    summary = "about 20.1 MB are still needed, or 23.1 MB if parameters or code"
    assert all(summary in finding.message for finding in findings)
    assert all("since the 3.0 MB in the store were made" in each.message for each in findings)
    assert not any(finding.is_error for finding in findings)


def test_clouds_of_the_whole_study_fit_into_the_estimate():
    """117 parts by 15 methods took 4957 MB on 2026-11-27."""
    assert 1.1 * 4957e6 < 117 * 15 * PER_CLOUD < 1.5 * 4957e6


def test_too_little_room_is_wrong(study: Path, bare_copy: WorkingCopy):
    room = shutil.disk_usage(bare_copy.folder).free
    views = int(2 * room / (100**2 * PER_PIXEL))
    study.write_text(study.read_text().replace("count: 8", f"count: {views}"))
    findings = bare_copy.check("disk")
    assert all(finding.is_error for finding in findings)
    assert "INDUSTNERF_STORE" in findings[0].message


def test_room_for_the_rest_is_not_called_too_little(study: Path, bare_copy: WorkingCopy):
    """A finished study on a disk that it filled is nobody's fault: what it holds may stay."""
    room = shutil.disk_usage(bare_copy.folder).free
    views = int(2 * room / (2 * 100**2 * PER_PIXEL))
    study.write_text(study.read_text().replace("count: 8", f"count: {views}"))
    assert all(finding.is_error for finding in bare_copy.check("disk"))
    (bare_copy.paths.store / "views" / "k").mkdir(parents=True)
    with (bare_copy.paths.store / "views" / "k" / "pictures").open("wb") as sparse:
        sparse.truncate(int(1.5 * room))
    (bare_copy.folder / "data").mkdir()
    (bare_copy.folder / "data" / "index.json").write_text('{"step": "views", "keys": {"a": "k"}}')
    findings = bare_copy.check("disk")
    assert not any(finding.is_error for finding in findings)
    assert all("if parameters or code changed" in finding.message for finding in findings)


NAMESPACE = "unshare --user --map-root-user --mount sh -c"  # its mounts end with it
MOUNT = "mount -t tmpfs -o size=1m tmpfs store"
FILL = "head -c 2M /dev/zero > store/filler; ls -l store"


def on_a_full_disk(bare_copy: WorkingCopy, store: str) -> tuple[int, str]:
    """What the command says where nothing more can be written to `store`.

    Skips the test where not even the root of a namespace may mount.
    """
    bare_copy.paths.store.mkdir(exist_ok=True)
    if bare_copy.run(f"{NAMESPACE} '{MOUNT}'")[0]:
        pytest.skip("no disk can be filled here: neither root nor anybody else may mount one")
    command = f"INDUSTNERF_STORE={store} {sys.executable} -m industnerf.doctor disk"
    return bare_copy.run(f"{NAMESPACE} '{MOUNT}; {FILL}; {command}'")


def test_a_full_disk_is_wrong_and_a_larger_one_mends_it(study: Path, bare_copy: WorkingCopy):
    code, output = on_a_full_disk(bare_copy, "store")
    assert "No space left on device" in output
    assert f" {2**20} " in output  # bytes of the two million came down
    assert "  store: 0.0 MB are free, about 23.1 MB are still needed; free some" in output
    assert output.endswith("1 thing is wrong\n")  # for beside the store there is room
    assert code == 1
    larger = bare_copy.folder / ".store"
    assert f"    mend: export INDUSTNERF_STORE={larger}\n" in output
    code, output = on_a_full_disk(bare_copy, str(larger))
    assert output.endswith("nothing is wrong\n")
    assert code == 0


def test_on_one_full_disk_dvc_lets_go_of_what_nothing_else_holds(dvc_copy: WorkingCopy, root: Path):
    """Of the output of today, which is linked, it does not; then there is no command left."""
    values = yaml.safe_load((root / "params.yaml").read_text())
    values["views"]["count"] = 10**9
    values["parts"]["select"] = ["a"]
    (dvc_copy.folder / "params.yaml").write_text(yaml.safe_dump(values))
    assert [(finding.fix, finding.is_error) for finding in dvc_copy.check("disk")] == [
        ("", True)
    ] * 2
    add_and_forget = "head -c 3M /dev/zero > big && dvc add -q big && rm big big.dvc"
    assert dvc_copy.run(add_and_forget)[0] == 0
    findings = dvc_copy.check("disk")
    assert all(
        "DVC's cache can give back 3.1 MB at most" in finding.message for finding in findings
    )
    assert {finding.fix for finding in findings} == {"(cd . && dvc gc --workspace --force)"}
    code, output = dvc_copy.run(findings[0].fix)
    assert code == 0, output
    assert [finding.fix for finding in dvc_copy.check("disk")] == [""] * 2
    assert dvc_copy.check("cache") == []
    assert (dvc_copy.folder / "data/out/a").exists()


def test_parameters_that_are_wrong_are_a_finding(study: Path, bare_copy: WorkingCopy):
    study.write_text(study.read_text().replace("seed: 0", "sead: 0"))
    (finding,) = bare_copy.check("disk")
    assert finding.is_error
    assert "sead is unknown" in finding.message
