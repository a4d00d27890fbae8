"""What does each further view tell 3D-R2N2?

OMP_NUM_THREADS=1 python benchmarks/r2n2_views.py DATA

DATA is the folder `data` of a finished run, of which `parts`, `views`, `truth` and `split.json` are
read.  The net learns as in params.yaml, once a fold, from one to five views at a time; it is then
shown one to five of each part of the fold, the farthest apart.  EMD is P1-even, the mean over the
reported parts; beside it the mean of what it is more than with one view, with an interval from a
bootstrap over families.
"""

import multiprocessing
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from statistics import fmean

from nets import Job, emd, run

from industnerf.artifacts.part import load_parts
from industnerf.artifacts.split import load_split
from industnerf.config import load_params
from industnerf.report.formats import markdown
from industnerf.report.statistics import paired_change

METHOD, VIEWS = "r2n2", (1, 2, 3, 4, 5)


def asked(job: Job) -> dict[int, dict[str, float]]:
    """Views shown -> the EMD of each reported part of the fold."""
    state = run(job).state
    parts = [
        part
        for part, place in load_split(job.data / "split.json").items()
        if place.fold == job.fold and place.split == "test"
    ]
    shown = {count: replace(job, settings=replace(job.settings, views=count)) for count in VIEWS}
    return {count: {part: emd(one, state, part) for part in parts} for count, one in shown.items()}


def main() -> None:
    data = Path(sys.argv[1])
    folds = {place.fold for place in load_split(data / "split.json").values()}
    settings = load_params().method.r2n2
    jobs = [Job(data, METHOD, fold, 1, settings) for fold in sorted(folds)]
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
        found = list(pool.map(asked, jobs))
    emds = {count: {p: x for one in found for p, x in one[count].items()} for count in VIEWS}
    families = {part.part_id: part.family for part in load_parts(data / "parts")}
    rows = [
        [
            str(count),
            f"{fmean(of.values()):.4f}",
            *(gain(emds[1], of, families) if count > 1 else [""] * 3),
        ]
        for count, of in emds.items()
    ]
    print(markdown(["views", "EMD even", "more than with one", "95 %", "better on"], rows))


def gain(one: dict[str, float], more: dict[str, float], families: dict[str, str]) -> list[str]:
    change = paired_change(one, more, families, load_params().report, seed=0)
    ends = f"{change.low:+.4f} to {change.high:+.4f}"
    return [f"{change.mean:+.4f}", ends, f"{change.lower} of {len(one)}"]


if __name__ == "__main__":
    main()
