"""Beside which methods of a study the published spread over seeds may stand.

Settings change under a name that stays, so no name of a preset says that the spread is of them.
What says it is the measured: on the fixed parts a method has the mean that it had in the sweep.
"""

from dataclasses import replace
from pathlib import Path

from industnerf.report.gather import Study
from industnerf.report.lookup import EVEN, only, scores_of
from industnerf.report.spread import ByMethod, is_run_of
from industnerf.report.spread_files import read_seeds
from industnerf.report.subsets import seed_parts


def with_spread(study: Study, seeds: Path) -> Study:
    """`study` with the standard deviations in the folder `seeds` that are of its methods."""
    emds = _fixed(study)
    known = [row for row in read_seeds(seeds) if is_run_of(row, study.seed, emds.get(row.method))]
    return replace(study, seeds_sd={row.method: row.sd for row in known})


def _fixed(study: Study) -> ByMethod:
    """The EMDs (even) of the fixed parts."""
    even = {name: only(scores_of(study, name, "test"), *EVEN) for name in study.methods}
    fixed = seed_parts({row.part_id for rows in even.values() for row in rows})
    return {
        name: {row.part_id: row.score.value for row in rows if row.part_id in fixed}
        for name, rows in even.items()
    }
