"""Bring the finished study's numbers under version control: `make results`.

results/study    tables, scores, costs, small pictures, machine and commit
README.md        what stands between its marks `study`
docs/            the same of baselines.md, scaling.md and readings.md

python -m pipeline.publish readme    the documents alone: after params.yaml has changed, they say so
python -m pipeline.publish organic   the same of a finished preset: runs/organic to results/organic

The order, with the spread over seeds: `pipeline.spread` and its sweeps, `make repro`, whose report
shows it, and this.  After a spread that came later, `pipeline.retable` and then `pipeline.publish
readme`.  `pipeline.spread` without a sweep takes its mm from results/study: it comes after this.
"""

import json
import subprocess
from pathlib import Path

from industnerf.artifacts.files import write_text
from industnerf.cli import require_dvc, run_command
from industnerf.config import PARAMS, load_params
from industnerf.errors import BadArtifact, BadParams
from industnerf.parts.catalogue import EMBEDDED
from industnerf.report.blocks import replace_block
from industnerf.report.documents import cluster_block, costs_block, nets_block
from industnerf.report.leakage import leakage_block, measured
from industnerf.report.measuring import measuring_block
from industnerf.report.provenance import made_by
from industnerf.report.publish import publish
from industnerf.report.readme import study_block
from industnerf.report.sweep_index import PRESETS, brought_by, sweeping
from industnerf.schema import Params

OUT, README = Path("results/study"), Path("README.md")
GRID = Path("results/grid")  # which docs/readings.md shows beside the study
SEEDS = Path("results/seeds")  # whose mm are those of the study
LEAKAGE = Path("docs/sweeps/leakage")  # a sweep that docs/baselines.md shows too


def main(what: str = "study") -> None:
    if what not in ("study", "readme"):
        bring(Path("runs") / what, Path("results") / what, f"python -m pipeline.preset {what}")
        return
    if what == "study":
        refuse_own_parts(load_params())
        if LEAKAGE.exists():
            measured(LEAKAGE)  # raises before anything is copied
        bring(Path(), OUT, "make repro")
    documents = shown(OUT, PARAMS)
    for document, blocks in documents.items():
        text = document.read_text(encoding="utf-8")
        for name, content in blocks.items():
            text = replace_block(text, name, content)
        write_text(document, text)
    if what == "readme":
        print(f"wrote {', '.join(map(str, documents))}")
        return
    then = "; then python -m pipeline.spread" if SEEDS.exists() else ""
    print(f"{OUT}, {README} and docs: commit them together with dvc.lock{then}")


def refuse_own_parts(params: Params) -> None:
    """Raises BadParams unless the parts are the catalogue that ships with the suite."""
    if params.parts.source == "path" or Path(params.parts.path).resolve() != EMBEDDED.resolve():
        raise BadParams(
            f"parts.path is {params.parts.path}, and {OUT} is the study of the embedded ones: "
            "give others a preset in conf/experiment/, `python -m pipeline.preset NAME`"
        )


def shown(study: Path, params: Path) -> dict[Path, dict[str, str]]:
    """What documents show of the published study, by document and the name of its marks."""
    leakage = {"leakage": leakage_block(LEAKAGE, study)} if LEAKAGE.exists() else {}
    readings = {"measuring": measuring_block(study, GRID)} if GRID.exists() else {}
    return {
        README: {"study": study_block(study, params)},
        Path("docs/baselines.md"): {"nets": nets_block(study), **leakage},
        Path("docs/scaling.md"): {"costs": costs_block(study), "cluster": cluster_block(study)},
        **({Path("docs/readings.md"): readings} if readings else {}),
    }


def bring(project: Path, out: Path, command: str) -> None:
    """Publish the report of `project`, which `command` ran, in the folder `out`."""
    check_finished(project, command)
    params = load_params(project / PARAMS)
    facts = {"preset": params.preset, "interval": params.report.interval}
    publish(project / "reports", out, made_by(command) | facts, project)


def check_finished(project: Path, command: str, but: str = "") -> None:
    """Raises BadArtifact if a stage is not up to date: its numbers are not those of this tree.

    The stage `but` may be.  `command` is what brings all of them up to date.
    """
    if not (project / PARAMS).exists():
        raise BadArtifact(f"{project} holds no run{_instead(project)}")
    require_dvc()
    status = subprocess.run(
        ["dvc", "status", "--json"], cwd=project, capture_output=True, text=True
    )
    if status.returncode:
        raise BadArtifact(f"`dvc status` failed: {status.stderr.strip()}")
    outdated = [stage for stage in json.loads(status.stdout) if stage != but]
    if outdated:
        raise BadArtifact(
            f"the study is not finished: {len(outdated)} stages are not up to date, the first is "
            f"{outdated[0]}: `{command}` goes on"
        )


def _instead(project: Path) -> str:
    """What would run `project`; where no preset would, the projects that have run."""
    name = project.name
    if name in sweeping(Path.cwd()):
        sweep = f"`python -m pipeline.sweep experiment={name}`"
        return f": {sweep}, which `python -m {brought_by(name)}` publishes"
    if (PRESETS / f"{name}.yaml").exists():
        return f": `python -m pipeline.preset {name}`"
    runs = sorted(path.parent.name for path in project.parent.glob(f"*/{PARAMS}"))
    return f"; these do: {', '.join(runs) or 'none'}"


if __name__ == "__main__":
    run_command(main)
