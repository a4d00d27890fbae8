"""Bring the finished study's numbers under version control: `make results`.

results/study    tables, scores, costs, small pictures, machine and commit
README.md        what stands between its marks `study`
docs/            the same of baselines.md, scaling.md and readings.md

python -m pipeline.publish readme    the documents alone: after params.yaml has changed, they say so
python -m pipeline.publish organic   the same of a finished preset: runs/organic to results/organic

The order, with the spread over seeds: `pipeline.seed_variance` and its sweeps, `make repro`, whose report
shows it, and this.  After a spread that came later, `pipeline.rebuild_tables` and then `pipeline.publish
readme`.  `pipeline.seed_variance` without a sweep takes its mm from results/study: it comes after this.
"""

import json
import subprocess
from pathlib import Path

from industnerf.artifacts.files import write_text
from industnerf.cli import require_dvc, run_command
from industnerf.config import PARAMS, load_params
from industnerf.errors import BadArtifact, BadParams
from industnerf.parts.catalogue.entries import EMBEDDED_FOLDER
from industnerf.report.docs.leakage import leakage_block, read_leakage_sweep
from industnerf.report.docs.markdown_blocks import replace_block
from industnerf.report.docs.protocol_readings import protocol_block
from industnerf.report.docs.readme_tables import study_block
from industnerf.report.docs.study_tables import cluster_block, costs_block, nets_block
from industnerf.report.publish.provenance import build_provenance
from industnerf.report.publish.study_folder import publish_study
from industnerf.report.sweeps.preset_table import PRESETS, multirun_presets, publishing_module
from industnerf.schema import Params

OUT, README = Path("results/study"), Path("README.md")
GRID = Path("results/grid")  # which docs/reference/readings.md shows beside the study
SEEDS = Path("results/seeds")  # whose mm are those of the study
LEAKAGE = Path(
    "docs/reference/sweeps/leakage"
)  # a sweep that docs/reference/baselines.md shows too


def main(target: str = "study") -> None:
    if target not in ("study", "readme"):
        publish_run(
            Path("runs") / target, Path("results") / target, f"python -m pipeline.preset {target}"
        )
        return
    if target == "study":
        require_embedded_parts(load_params())
        if LEAKAGE.exists():
            read_leakage_sweep(LEAKAGE)  # raises before anything is copied
        publish_run(Path(), OUT, "make repro")
    documents = document_blocks(OUT, PARAMS)
    for document, blocks in documents.items():
        text = document.read_text(encoding="utf-8")
        for name, content in blocks.items():
            text = replace_block(text, name, content)
        write_text(document, text)
    if target == "readme":
        print(f"wrote {', '.join(map(str, documents))}")
        return
    next_step = "; then python -m pipeline.seed_variance" if SEEDS.exists() else ""
    print(f"{OUT}, {README} and docs: commit them together with dvc.lock{next_step}")


def require_embedded_parts(params: Params) -> None:
    """Raises BadParams unless the parts are the catalogue that ships with the suite."""
    if (
        params.parts.source == "path"
        or Path(params.parts.path).resolve() != EMBEDDED_FOLDER.resolve()
    ):
        raise BadParams(
            f"parts.path is {params.parts.path}, and {OUT} is the study of the embedded ones: "
            "give others a preset in conf/experiment/, `python -m pipeline.preset NAME`"
        )


def document_blocks(study: Path, params: Path) -> dict[Path, dict[str, str]]:
    """What documents show of the published study, by document and the name of its marks."""
    leakage = {"leakage": leakage_block(LEAKAGE, study)} if LEAKAGE.exists() else {}
    reading_blocks = {"measuring": protocol_block(study, GRID)} if GRID.exists() else {}
    return {
        README: {"study": study_block(study, params)},
        Path("docs/reference/baselines.md"): {"nets": nets_block(study), **leakage},
        Path("docs/reference/scaling.md"): {
            "costs": costs_block(study),
            "cluster": cluster_block(study),
        },
        **({Path("docs/reference/readings.md"): reading_blocks} if reading_blocks else {}),
    }


def publish_run(project: Path, out: Path, command: str) -> None:
    """Publish the report of `project`, which `command` ran, in the folder `out`."""
    check_finished(project, command)
    params = load_params(project / PARAMS)
    metadata = {"preset": params.preset, "interval": params.report.confidence_level}
    publish_study(project / "reports", out, build_provenance(command) | metadata, project)


def check_finished(project: Path, command: str, allowed_stale: str = "") -> None:
    """Raises BadArtifact if a stage is not up to date: its numbers are not those of this tree.

    The stage `but` may be.  `command` is what brings all of them up to date.
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
