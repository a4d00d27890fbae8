"""Run a preset of conf/experiment/ through DVC, beside your own study: runs/<preset>/.

python -m pipeline.preset demo
"""

import os
import re
import shutil
import subprocess
from itertools import takewhile
from pathlib import Path
from typing import Any

from hydra import compose, initialize_config_dir
from hydra.errors import HydraException
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

from industnerf.artifacts.files import write_text
from industnerf.artifacts.part_warnings import print_part_warnings
from industnerf.cli import require_dvc, run_command
from industnerf.config import build, read_yaml
from industnerf.doctor import lockfile
from industnerf.errors import BadParams, SuiteError
from industnerf.parts.io.cad_files import require_path
from industnerf.renamed import check_overrides, flatten_preset
from industnerf.report.terminal_summary import SUMMARY, print_summary
from industnerf.runner import die_with_parent
from industnerf.schema import Params
from industnerf.store import Store
from industnerf.suggestions import did_you_mean
from industnerf.tracking import database_dir, is_enabled

HEADER_PATTERN = re.compile(r"#\s*@package\s+_global_")
# No links: whoever writes to an output would write into DVC's cache, which DVC then hands out.
DVC_CONFIG = """[core]
    analytics = false
    no_scm = True
[cache]
    type = "reflink,copy"
"""
CODE_PATHS = ("src", "pipeline", "conf", "dvc.yaml", "constraints.txt")
SHARED_PATHS = (
    *CODE_PATHS,
    *("data/embedded", "data/organic", "data/pretrained", "results/grid", "results/seeds"),
)


def main(preset: str) -> None:
    require_dvc()
    root = Path.cwd()
    presets = sorted(path.stem for path in root.glob("conf/experiment/*.yaml"))
    if preset not in presets:
        advice = did_you_mean(preset, presets) or ","
        raise BadParams(f"preset {preset!r} is unknown{advice} known are {', '.join(presets)}")
    settings = read_preset(root / "conf/experiment" / f"{preset}.yaml")
    if settings.get("hydra", {}).get("mode") == "MULTIRUN":
        raise BadParams(f"{preset!r} is a sweep: python -m pipeline.sweep experiment={preset}")
    project = root / "runs" / preset
    create_project(root, project, [f"experiment={preset}"])
    lockfile.replace_torn(project)
    # whatever is relative is relative to the root, not to the project
    os.environ["INDUSTNERF_STORE"] = str(Store.from_environment().root)
    if is_enabled():
        os.environ["INDUSTNERF_MLFLOW"] = str(database_dir())
    os.environ[SUMMARY] = "off"
    # Quiet, for stages say themselves how far they are.  A `dvc` that outlives its parent would
    # keep the next one out.
    if subprocess.run(["dvc", "repro", "-q"], cwd=project, preexec_fn=die_with_parent).returncode:
        # of an error of its own, such as a lock that is held, DVC has said nothing so
        subprocess.run(
            ["dvc", "repro", "--dry", "-s", "report"], cwd=project, stdout=subprocess.DEVNULL
        )
        raise SuiteError(f"preset {preset!r} did not finish; see above. Finished parts are kept.")
    for stage in ("parts", "views"):  # again, for DVC runs no stage that has nothing to do
        print_part_warnings(project / "data" / stage, stage)
    print_summary(project / "reports", (project / "reports").relative_to(root))


def read_preset(path: Path) -> dict[str, Any]:
    """The values of a preset.

    Raises BadParams if they would be a group's and change nothing, or if one has another name now.
    """
    if not any(map(HEADER_PATTERN.fullmatch, header_lines(path.read_text(encoding="utf-8")))):
        raise BadParams(
            f"{path} does not begin with the line '# @package _global_': its values would change "
            "nothing"
        )
    values = read_yaml(path)
    check_overrides(flatten_preset(values))
    return values


def header_lines(text: str) -> list[str]:
    """The lines that Hydra looks for directives in: up to the first that is something else."""
    lines = [line.strip() for line in text.splitlines()]
    return list(takewhile(lambda line: not line or re.match(r"#\s*@", line), lines))


def compose_params(root: Path, overrides: list[str]) -> Any:
    """params.yaml with `overrides`; raises BadParams with Hydra's reason if they do not fit."""
    try:
        with initialize_config_dir(str(root / "conf"), version_base="1.3"):
            return OmegaConf.to_container(compose("config", overrides))
    except (HydraException, OmegaConfBaseException) as error:
        reason = " ".join(str(error).split())
        raise BadParams(f"{' '.join(overrides)}: {reason}") from None


def create_project(root: Path, project: Path, overrides: list[str]) -> None:
    """A DVC project that shares code and catalogue with `root` and has a params.yaml of its own."""
    (project / "data").mkdir(parents=True, exist_ok=True)
    os.environ["INDUSTNERF_ROOT"] = str(root)  # where conf/config.yaml looks for params.yaml
    values = compose_params(root, overrides)
    build(Params, values, " ".join(overrides))
    values["parts"]["path"] = str(
        _relative_to_project(root, project, Path(values["parts"]["path"]))
    )
    OmegaConf.save(values, project / "params.yaml")
    for name in SHARED_PATHS:
        link = project / name
        if not link.is_symlink():
            link.parent.mkdir(exist_ok=True)
            link.symlink_to(os.path.relpath(root / name, link.parent))
    if not (project / ".dvc").is_dir():
        subprocess.run(["dvc", "init", "--no-scm", "-q"], cwd=project, check=True)
    write_text(project / ".dvc" / "config", DVC_CONFIG)
    shutil.copyfile(root / ".dvcignore", project / ".dvcignore")  # in place of what init wrote


def _relative_to_project(root: Path, project: Path, path: Path) -> Path:
    """The place of the parts, relative to `root`, as the project finds it, which shares
    SHARED_PATHS.

    It stays relative, for a published result says no more of a machine than its user wrote.
    Raises BadParams if it is the user's own and not there.
    """
    if any(path.is_relative_to(name) for name in SHARED_PATHS):
        return path
    require_path(root / path)
    return path if path.is_absolute() else Path(os.path.relpath(root / path, project))


if __name__ == "__main__":
    run_command(main)
