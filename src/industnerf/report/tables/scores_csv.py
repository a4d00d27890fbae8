"""`scores.csv`: every score of a study."""

from industnerf.artifacts.scores import PartScore
from industnerf.report.study import Study
from industnerf.report.tables.formats import csv_text

SCORE_COLUMNS = (
    "part_id",
    "family",
    "method",
    "scope",
    "split",
    "preset",
    "seed",
    "metric",
    "protocol",
    "value",
    "floor",
    "unit",
    "status",
)


def scores_csv(study: Study) -> str:
    """`scores.csv`: every score with its family, split, preset and seed."""
    return csv_text(SCORE_COLUMNS, [_score_row(study, row) for row in study.scores])


def _score_row(study: Study, row: PartScore) -> list[object]:
    score = row.score
    return [
        row.part_id,
        study.parts[row.part_id].family,
        row.method,
        study.methods[row.method].scope.value,
        study.assignments[row.part_id].split,
        study.preset,
        study.seed,
        score.metric,
        score.protocol,
        _lossless_text(score.value),
        _lossless_text(score.floor),
        score.unit,
        score.status,
    ]


def _lossless_text(value: float) -> str:
    """The number itself when read back: small differences of scores need all of its digits."""
    return repr(float(value)).removesuffix(".0")
