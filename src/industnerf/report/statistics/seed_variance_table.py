"""Beside which methods of a study the published spread over seeds may stand.

Settings change under a name that stays, so no name of a preset says that the spread is of them.
What says it is the measured: on the fixed parts a method has the mean that it had in the sweep.
"""

from dataclasses import replace
from pathlib import Path

from industnerf.report.part_subsets import seed_parts
from industnerf.report.statistics.seed_variance import EmdsByMethod, matches_run
from industnerf.report.statistics.seed_variance_io import read_seed_variances
from industnerf.report.study import Study
from industnerf.report.tables.score_lookup import EMD_EVEN, scores_of, select_scores


def add_seed_variance(study: Study, folder: Path) -> Study:
    """`study` with the standard deviations in the folder `seeds` that are of its methods."""
    emds = _fixed_part_emds(study)
    matching = [
        row
        for row in read_seed_variances(folder)
        if matches_run(row, study.seed, emds.get(row.method))
    ]
    return replace(study, seeds_sd={row.method: row.sd for row in matching})


def _fixed_part_emds(study: Study) -> EmdsByMethod:
    """The EMDs (even) of the fixed parts."""
    even_scores = {
        name: select_scores(scores_of(study, name, "test"), *EMD_EVEN) for name in study.methods
    }
    fixed = seed_parts({row.part_id for rows in even_scores.values() for row in rows})
    return {
        name: {row.part_id: row.score.value for row in rows if row.part_id in fixed}
        for name, rows in even_scores.items()
    }
