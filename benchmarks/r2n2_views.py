"""How much does 3D-R2N2 gain from each further view?

OMP_NUM_THREADS=1 python benchmarks/r2n2_views.py DATA

DATA is the folder `data` of a finished run, of which `parts`, `views`, `truth` and `split.json` are
read.  The network is trained as in params.yaml, once a fold, on one to five views at a time, and
then reconstructs from one to five of each part of the fold, the farthest apart.  EMD is P1-even,
the mean over the reported parts; beside it the mean difference from one view, with an interval
from a bootstrap over families.
"""

import multiprocessing
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from statistics import fmean

from nets import Job, mean_emd, run

from industnerf.artifacts.part import load_parts
from industnerf.artifacts.split import load_split
from industnerf.config import load_params
from industnerf.report.statistics.significance import paired_change
from industnerf.report.tables.formats import format_interval, markdown_table

METHOD, VIEWS = "r2n2", (1, 2, 3, 4, 5)


def emd_by_view_count(job: Job) -> dict[int, dict[str, float]]:
    """Views shown -> the EMD of each reported part of the fold."""
    state = run(job).state
    parts = [
        part
        for part, assignment in load_split(job.data / "split.json").items()
        if assignment.fold == job.fold and assignment.split == "test"
    ]
    jobs_by_count = {
        count: replace(job, settings=replace(job.settings, max_views=count)) for count in VIEWS
    }
    return {
        count: {part: mean_emd(view_job, state, part) for part in parts}
        for count, view_job in jobs_by_count.items()
    }


def main() -> None:
    data = Path(sys.argv[1])
    folds = {assignment.fold for assignment in load_split(data / "split.json").values()}
    settings = load_params().method.r2n2
    jobs = [Job(data, METHOD, fold, 1, settings) for fold in sorted(folds)]
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
        results = list(pool.map(emd_by_view_count, jobs))
    emds = {
        count: {p: x for result in results for p, x in result[count].items()} for count in VIEWS
    }
    families = {part.part_id: part.family for part in load_parts(data / "parts")}
    rows = [
        [
            str(count),
            f"{fmean(by_part.values()):.4f}",
            *(gain(emds[1], by_part, families) if count > 1 else [""] * 3),
        ]
        for count, by_part in emds.items()
    ]
    print(markdown_table(["views", "EMD even", "more than with one", "95 %", "better on"], rows))


def gain(
    single_view: dict[str, float], more_views: dict[str, float], families: dict[str, str]
) -> list[str]:
    change = paired_change(single_view, more_views, families, load_params().report, seed=0)
    ends = format_interval(change.low, change.high, "+.4f")
    return [f"{change.mean:+.4f}", ends, f"{change.num_lower} of {len(single_view)}"]


if __name__ == "__main__":
    main()
