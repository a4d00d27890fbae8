"""Score clouds that were made elsewhere, as the study scores its own.

python -m pipeline.score clouds/                       files named after parts: gear-spur-m2-z24.ply
python -m pipeline.score cloud.ply gear-spur-m2-z24    one cloud of a part of the suite
python -m pipeline.score cloud.ply bracket.step        one cloud of a CAD file of your own
    --min-opacity 0.5    of Gaussian splats, the least that counts (0)

The protocol, P1 (docs/reference/protocol.md):
  EMD: 4096 farthest points of the cloud against 4096 of the true surface, both as far as a rig of
       40 cameras sees them; exact, the mean distance of the best one-to-one match, in diagonals.
  floor: the same of a second sample of the true surface, which is what a perfect cloud scores.

Clouds are in mm, in the frame of the part and of its `transforms.json`: PLY, PCD, npz with
`points_mm`, npy, and text (XYZ, CSV, TXT, PTS, ASC).  Of a mesh, in any format that `parts check`
reads, points are drawn evenly by area.  Points that are not finite do not count.  A file without
points is a failure, and counts as one; a part without a file does not count.  Where all fail, the
exit code is 2.  Resumable; the truth is in the store.
"""

from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Column, Table

from industnerf.artifacts.cloud import load_warnings
from industnerf.artifacts.part import load_parts
from industnerf.artifacts.scores import PartScore, gather_scores, load_method_scores
from industnerf.cli import run_command
from industnerf.config import StageParams, load_params, load_stage, read_yaml
from industnerf.errors import BadArtifact, BadParams
from industnerf.external.files import cad_file, find_clouds, select_catalogue, user_cad
from industnerf.external.points import import_points
from industnerf.external.report_folders import report_folder, start_report
from industnerf.external.table import (
    COLUMNS,
    LEGEND,
    PublishedScores,
    load_published_scores,
    part_rows,
    summary,
)
from industnerf.schema import Params
from industnerf.stage import Task, read_failures, read_index, run_stage
from pipeline.stages import evaluate, parts, solids, truth

OUT, STUDY = Path("runs/score"), Path("results/study")


def main(path: str, part: str = "", *, min_opacity: str = "0") -> None:
    opacity = _parse_opacity(min_opacity)
    cad_path = cad_file(part)
    params, clouds = resolve_inputs(load_params(), Path(path), part, cad_path)
    cloud_path = Path(path).resolve()
    subject = str(cad_path.resolve()) if cad_path else part
    out = report_folder(
        OUT, cloud_path, subject, (cloud_path, Path(params.parts.path), *clouds.values())
    )
    start_report(out, cloud_path, subject)
    score_clouds(params, clouds, out, opacity)
    print_scores(params, out)
    require_scored(out)


def _parse_opacity(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0 <= value <= 1:
        raise BadParams(f"--min-opacity {text}: must be a number from 0 to 1")
    return value


def resolve_inputs(
    params: Params, path: Path, part: str, cad_path: Path | None
) -> tuple[Params, dict[str, Path]]:
    """The parameters that bring in the parts, and the file of the cloud of each.

    `cad_path` is the file that `part` names, if it names one.
    """
    if cad_path:
        parts_params, part_id = user_cad(params.parts, cad_path)
        clouds = find_clouds(path, part_id)
    else:
        clouds = find_clouds(path, part)
        parts_params = select_catalogue(params.parts, clouds)
    return replace(params, parts=parts_params), clouds


def score_clouds(
    params: Params, clouds: dict[str, Path], out: Path, min_opacity: float = 0.0
) -> None:
    """The stages of the study up to its scores, with the files in the place of a method.

    `out` holds no report; of what was scored before, the store has the results.  Gaussian splats
    below `min_opacity` do not count.
    """
    source, solids_dir, parts_dir, truth_dir, clouds_dir = (
        params.parts.path,
        *(str(out / name) for name in ("solids", "parts", "truth", "clouds")),
    )
    solids.main(stage_params(params, "solids"), source, solids_dir)
    parts.main(stage_params(params, "parts"), source, solids_dir, parts_dir)
    truth.main(stage_params(params, "truth"), parts_dir, truth_dir)
    settings = (params.evaluate.max_points, params.evaluate.points, min_opacity, params.seed)
    tasks = [
        Task(
            part_id,
            partial(import_points, clouds[part_id], Path(parts_dir) / part_id, *settings),
            [*settings, part_id],
            (
                clouds[part_id],
                *(Path(parts_dir) / part_id / name for name in ("mesh.npz", "part.json")),
            ),
        )
        for part_id in read_index(Path(parts_dir))
    ]
    earlier_failures = read_failures(Path(parts_dir))
    run_stage(
        "clouds",
        tasks,
        Path(clouds_dir),
        "report",
        earlier_failures=earlier_failures,
        needs_one=False,
    )
    no_views = out / "views"  # a cloud without renderings asks for none
    folders = (Path(parts_dir), Path(truth_dir), no_views, Path(clouds_dir))
    failed = set(read_failures(Path(clouds_dir)))
    settings = stage_params(params, "evaluate")
    tasks = evaluate.evaluation_tasks(settings, folders, read_index(Path(truth_dir)), failed)
    run_stage("evaluate", tasks, out / "scores", "strict", failures_are_losses=True)
    gather_scores(out / "scores", out.name)


def stage_params(params: Params, name: str) -> StageParams:
    """What the stage `name` of dvc.yaml may read of `params`."""
    return load_stage(name).select_params(params)


def print_scores(params: Params, out: Path) -> None:
    """Print the scores below `out`, part by part and in the mean, beside the study's."""
    scores = load_method_scores(out / "scores", out.name)
    parts_by_id = {part.part_id: part for part in load_parts(out / "parts")}
    part_column = Column(COLUMNS[0], min_width=max(map(len, parts_by_id)))
    table = Table(part_column, *(Column(head, justify="right") for head in COLUMNS[1:]), box=SIMPLE)
    for row in part_rows(scores, parts_by_id):
        table.add_row(*row)
    Console().print(table)
    print(f"{LEGEND}\n")
    for part_id, reason in read_failures(out / "clouds").items():
        print(f"{part_id} failed: {reason}")
    for part_id in sorted(failed_parts(scores) - read_failures(out / "clouds").keys()):
        print(f"{part_id} counts as failed: no point of its cloud can be scored")
    for part_id in read_index(out / "clouds"):
        for warning in load_warnings(out / "clouds" / part_id):
            print(f"{part_id}: {warning}")
    study_scores, reason = published_scores(params)
    for text in summary(scores, parts_by_id, study_scores, params.report, params.seed):
        print(text)
    if reason:
        print(f"not compared with the study: {reason}")
    print(f"every metric: {out / 'scores' / 'scores.csv'}")


def require_scored(out: Path) -> None:
    """Raise BadArtifact if not one cloud below `out` was read and scored."""
    failed = read_failures(out / "clouds").keys() | failed_parts(
        load_method_scores(out / "scores", out.name)
    )
    if not read_index(out / "clouds").keys() - failed:
        if len(failed) == 1:
            raise BadArtifact("the cloud could not be scored; the reason stands above")
        raise BadArtifact(f"none of {len(failed)} clouds could be scored; the reasons stand above")


def failed_parts(scores: Sequence[PartScore]) -> set[str]:
    """The parts of which one of the `scores` is a failure's."""
    return {row.part_id for row in scores if row.score.status != "ok"}


def published_scores(params: Params) -> tuple[PublishedScores, str]:
    """The published study; of its values none, and why, if it was not scored as `params` say."""
    if params.parts.source == "path":  # a file may be called as one of the study's parts
        return PublishedScores({}, {}), "its parts are not your CAD file"
    if not STUDY.exists():
        return PublishedScores({}, {}), f"there is no {STUDY}"
    study_params, study_scores = read_yaml(STUDY / "params.yaml"), load_published_scores(STUDY)
    current = {"evaluate": asdict(params.evaluate), "seed": params.seed}
    differing = [key for key, value in current.items() if study_params[key] != value]
    if not differing:
        return study_scores, ""
    return PublishedScores(
        study_scores.splits, {}
    ), f"params.yaml has another {' and '.join(differing)}"


if __name__ == "__main__":
    run_command(main)
