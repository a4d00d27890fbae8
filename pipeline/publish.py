"""Bring finished results under version control, and README and documents up to date with them.

python -m pipeline.publish         `make results`: the study, to results/study
python -m pipeline.publish demo    a finished preset: runs/demo to results/demo, and so of any other

`python -m industnerf.report.docs` writes README and documents alone.

Order, with the variance over seeds: `pipeline.seed_variance` and its sweeps, `make repro`, whose
report shows it, then this.  After a variance that came later, `pipeline.rebuild_tables`.
`pipeline.seed_variance` without a sweep takes its mm from results/study: it comes after this.
"""

import json
import subprocess
from pathlib import Path

from PIL import Image

from industnerf.cli import require_dvc, run_command
from industnerf.config import PARAMS, load_params
from industnerf.errors import BadArtifact, BadParams
from industnerf.parts.catalogue.entries import EMBEDDED_FOLDER
from industnerf.report.docs.documents import DEMO, LEAKAGE, STUDY, write_documents
from industnerf.report.docs.learned_methods import read_leakage_sweep
from industnerf.report.publish.provenance import build_provenance
from industnerf.report.publish.study_folder import publish_study
from industnerf.report.sweeps.preset_table import PRESETS, multirun_presets, publishing_module
from industnerf.schema import Params

SEEDS = Path("results/seeds")  # whose mm are those of the study
DEMO_PICTURE, DEMO_PICTURE_PX = Path("docs/demo.png"), 2200  # px of its longer side


def main(target: str = "study") -> None:
    if target == "study":
        require_embedded_parts(load_params())
        if LEAKAGE.exists():
            read_leakage_sweep(LEAKAGE)  # raises before anything is copied
        publish_run(Path(), STUDY, "make repro")
    else:
        run_dir = Path("runs") / target
        publish_run(run_dir, Path("results") / target, f"python -m pipeline.preset {target}")
        if target == DEMO.name:
            save_demo_picture(run_dir / "reports/contact_sheet.png")
    written = write_documents(Path())
    print(f"wrote {', '.join(map(str, written))}")
    if target == "study":
        next_step = "; then python -m pipeline.seed_variance" if SEEDS.exists() else ""
        print(f"commit them together with {STUDY} and dvc.lock{next_step}")


def save_demo_picture(contact_sheet: Path) -> None:
    """The picture of the README, from the demo's contact sheet."""
    with Image.open(contact_sheet) as sheet:
        sheet.thumbnail((DEMO_PICTURE_PX, DEMO_PICTURE_PX))
        sheet.save(DEMO_PICTURE, optimize=True)


def require_embedded_parts(params: Params) -> None:
    """Raises BadParams unless the parts are the catalogue that ships with the suite."""
    if (
        params.parts.source == "path"
        or Path(params.parts.path).resolve() != EMBEDDED_FOLDER.resolve()
    ):
        raise BadParams(
            f"parts.path is {params.parts.path}, and {STUDY} is the study of the embedded ones: "
            "give others a preset in conf/experiment/, `python -m pipeline.preset NAME`"
        )


def publish_run(project: Path, out: Path, command: str) -> None:
    """Publish the report of `project`, which `command` ran, in the folder `out`.

    Raises BadArtifact if a stage is not up to date or a file is missing.
    """
    check_finished(project, command)
    params = load_params(project / PARAMS)
    metadata = {"preset": params.preset, "interval": params.report.confidence_level}
    publish_study(project / "reports", out, build_provenance(command) | metadata, project)


def check_finished(project: Path, command: str, allowed_stale: str = "") -> None:
    """Raises BadArtifact if a stage is not up to date: its numbers are not those of this tree.

    The stage `allowed_stale` may be.  `command` is what brings all of them up to date.
    """
    if not (project / PARAMS).exists():
        raise BadArtifact(f"{project} holds no run{_missing_run_hint(project)}")
    require_dvc()
    status = subprocess.run(
        ["dvc", "status", "--json"], cwd=project, capture_output=True, text=True
    )
    if status.returncode:
        raise BadArtifact(f"`dvc status` failed: {status.stderr.strip()}")
    outdated = [stage for stage in json.loads(status.stdout) if stage != allowed_stale]
    if outdated:
        raise BadArtifact(
            f"the study is not finished: {len(outdated)} stages are not up to date, the first is "
            f"{outdated[0]}: `{command}` goes on"
        )


def _missing_run_hint(project: Path) -> str:
    """What would run `project`; where no preset would, the projects that have run."""
    name = project.name
    if name in multirun_presets(Path.cwd()):
        sweep = f"`python -m pipeline.sweep experiment={name}`"
        return f": {sweep}, which `python -m {publishing_module(name)}` publishes"
    if (PRESETS / f"{name}.yaml").exists():
        return f": `python -m pipeline.preset {name}`"
    runs = sorted(path.parent.name for path in project.parent.glob(f"*/{PARAMS}"))
    return f"; these do: {', '.join(runs) or 'none'}"


if __name__ == "__main__":
    run_command(main)
