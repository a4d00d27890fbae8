"""One score out of thousands, or some of them: by part, method, split, metric and protocol."""

from dataclasses import dataclass

from industnerf.artifacts.scores import PartScore, Score
from industnerf.report.study import Study

EMD_EVEN = ("emd", "P1-even")
SPEARMAN = ("confidence_spearman", "P1-near")
AUSE, AUSE_RANDOM = ("confidence_ause", "P1-near"), ("confidence_ause_chance", "P1-near")


@dataclass(frozen=True)
class Scores:
    """All scores of a study."""

    by_key: dict[tuple[str, str, str, str], Score]

    @staticmethod
    def from_study(study: Study) -> "Scores":
        """Everything that `study` has been scored by."""
        return Scores(
            {
                (row.part_id, row.method, row.score.metric, row.score.protocol): row.score
                for row in study.scores
            }
        )

    def get(
        self, part_id: str, method: str, metric_key: tuple[str, str] = EMD_EVEN
    ) -> Score | None:
        """The score of `kind`, a metric and its protocol, if there is one."""
        return self.by_key.get((part_id, method, *metric_key))

    def units_by_metric_key(self) -> dict[tuple[str, str], str]:
        """Every metric and protocol, in the order in which they were measured, with its unit."""
        return {key[2:]: score.unit for key, score in self.by_key.items()}


def scores_of(study: Study, method: str, split: str) -> list[PartScore]:
    """The scores of `method` on the parts of `split`."""
    return [
        row
        for row in study.scores
        if row.method == method and study.assignments[row.part_id].split == split
    ]


def select_scores(scores: list[PartScore], metric: str, protocol: str) -> list[PartScore]:
    """Those of `scores` that are of one metric under one protocol."""
    return [row for row in scores if (row.score.metric, row.score.protocol) == (metric, protocol)]
