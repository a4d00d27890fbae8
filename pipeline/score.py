"""Score clouds that were made elsewhere, as the study scores its own (docs/protocol.md).

python -m pipeline.score clouds/                       files named after parts: gear-spur-m2-z24.ply
python -m pipeline.score cloud.ply gear-spur-m2-z24    one cloud of a part of the suite
python -m pipeline.score cloud.ply bracket.step        one cloud of a CAD file of your own

Clouds are in mm, in the frame of the part and of its `transforms.json`: PLY, XYZ, or npz with
`points_mm`; of a mesh (PLY, OBJ, STL, OFF) points are drawn.  A file without points is a failure,
and counts as one; a part without a file does not count.  Where all fail, the exit code is 1.
Resumable; the truth is in the store.
"""

from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path

from rich.box import SIMPLE
from rich.console import Console
from rich.table import Column, Table

from industnerf.artifacts.cloud import load_remarks
from industnerf.artifacts.part import load_parts
from industnerf.artifacts.scores import PartScore, load_method_scores
from industnerf.cli import run_command
from industnerf.config import Masked, load_params, read_yaml, stage
from industnerf.errors import PartsFailed
from industnerf.outside.files import baked, cad_file, clouds_at, own
from industnerf.outside.points import take_over
from industnerf.outside.reports import begin, folder_for
from industnerf.outside.table import HEADS, Known, known_of, part_lines, summary
from industnerf.schema import Params
from industnerf.stage import Task, read_failures, read_index, run_stage
from pipeline import evaluate, parts, solids, truth

OUT, STUDY = Path("runs/score"), Path("results/study")


def main(place: str, part: str = "") -> None:
    cad = cad_file(part)
    params, clouds = asked(load_params(), Path(place), part, cad)
    named = Path(place).resolve()
    of = str(cad.resolve()) if cad else part
    out = folder_for(OUT, named, of, (named, Path(params.parts.path), *clouds.values()))
    begin(out, named, of)
    score(params, clouds, out)
    show(params, out)
    require_one(out)


def asked(
    params: Params, place: Path, part: str, cad: Path | None
) -> tuple[Params, dict[str, Path]]:
    """The parameters that bring in the parts, and the file of the cloud of each.

    `cad` is the file that `part` names, if it names one.
    """
    if cad:
        chosen, part_id = own(params.parts, cad)
        clouds = clouds_at(place, part_id)
    else:
        clouds = clouds_at(place, part)
        chosen = baked(params.parts, clouds)
    return replace(params, parts=chosen), clouds


def score(params: Params, clouds: dict[str, Path], out: Path) -> None:
    """The stages of the study up to its scores, with the files in the place of a method.

    `out` holds no report; of what was scored before, the store has the results.
    """
    source, solid, part, known, cloud = (
        params.parts.path,
        *(str(out / name) for name in ("solids", "parts", "truth", "clouds")),
    )
    solids.main(masked(params, "solids"), source, solid)
    parts.main(masked(params, "parts"), source, solid, part)
    truth.main(masked(params, "truth"), part, known)
    cap = params.evaluate.cap
    tasks = [
        Task(
            part_id,
            partial(take_over, clouds[part_id], Path(part) / part_id, cap, params.seed),
            [cap, params.seed, part_id],
            (clouds[part_id], *(Path(part) / part_id / name for name in ("mesh.npz", "part.json"))),
        )
        for part_id in read_index(Path(part))
    ]
    before = read_failures(Path(part))
    run_stage("outside", tasks, Path(cloud), "report", failed_before=before, needs_one=False)
    no_views = str(out / "views")  # a cloud without renderings asks for none
    evaluate.main(
        masked(params, "evaluate"), out.name, part, no_views, known, cloud, str(out / "scores")
    )


def masked(params: Params, name: str) -> Masked:
    """What the stage `name` of dvc.yaml may read of `params`."""
    return stage(name).mask(params)


def show(params: Params, out: Path) -> None:
    """Print the scores below `out`, part by part and in the mean, beside the study's."""
    found = load_method_scores(out / "scores", out.name)
    known = {part.part_id: part for part in load_parts(out / "parts")}
    wide = Column(HEADS[0], min_width=max(map(len, known)))
    table = Table(wide, *(Column(head, justify="right") for head in HEADS[1:]), box=SIMPLE)
    for line in part_lines(found, known):
        table.add_row(*line)
    Console().print(table)
    for part_id, why in read_failures(out / "clouds").items():
        print(f"{part_id} failed: {why}")
    said = read_failures(out / "clouds") | read_failures(out / "scores")
    for part_id, why in read_failures(out / "scores").items():
        print(f"{part_id} counts as failed, it could not be scored: {why}")
    for part_id in sorted(failing(found) - said.keys()):
        print(f"{part_id} counts as failed: no point of its cloud can be scored")
    for part_id in read_index(out / "clouds"):
        for remark in load_remarks(out / "clouds" / part_id):
            print(f"{part_id}: {remark}")
    beside, why = published(params)
    for text in summary(found, known, beside, params.report, params.seed):
        print(text)
    if why:
        print(f"not set beside the study: {why}")
    print(f"every metric: {out / 'scores' / 'scores.csv'}")


def require_one(out: Path) -> None:
    """Raise PartsFailed if not one cloud below `out` was read and scored."""
    said = read_failures(out / "clouds") | read_failures(out / "scores")
    failed = said.keys() | failing(load_method_scores(out / "scores", out.name))
    if not read_index(out / "clouds").keys() - failed:
        if len(failed) == 1:
            raise PartsFailed("the cloud could not be scored; the reason stands above")
        raise PartsFailed(f"none of {len(failed)} clouds could be scored; the reasons stand above")


def failing(scores: Sequence[PartScore]) -> set[str]:
    """The parts of which one of the `scores` is a failure's."""
    return {row.part_id for row in scores if row.score.status != "ok"}


def published(params: Params) -> tuple[Known, str]:
    """The published study; of its values none, and why, if it was not scored as `params` say."""
    if params.parts.source == "path":  # a file may be called as one of the study's parts
        return Known({}, {}), "its parts are not your CAD file"
    if not STUDY.exists():
        return Known({}, {}), f"there is no {STUDY}"
    then, known = read_yaml(STUDY / "params.yaml"), known_of(STUDY)
    now = {"evaluate": asdict(params.evaluate), "seed": params.seed}
    others = [key for key, value in now.items() if then[key] != value]
    if not others:
        return known, ""
    return Known(known.splits, {}), f"params.yaml has another {' and '.join(others)}"


if __name__ == "__main__":
    run_command(main)
