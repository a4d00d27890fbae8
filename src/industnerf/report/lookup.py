"""One score out of thousands, by part, method, metric and protocol."""

from dataclasses import dataclass

from industnerf.artifacts.scores import Score
from industnerf.report.gather import Study

EVEN = ("emd", "P1-even")


@dataclass(frozen=True)
class Scores:
    """All scores of a study."""

    found: dict[tuple[str, str, str, str], Score]

    @staticmethod
    def of(study: Study) -> "Scores":
        """Everything that `study` has been scored by."""
        return Scores(
            {
                (row.part_id, row.method, row.score.metric, row.score.protocol): row.score
                for row in study.scores
            }
        )

    def get(self, part_id: str, method: str, kind: tuple[str, str] = EVEN) -> Score | None:
        """The score of `kind`, a metric and its protocol, if there is one."""
        return self.found.get((part_id, method, *kind))

    def kinds(self) -> dict[tuple[str, str], str]:
        """Every metric and protocol, in the order in which they were measured, with its unit."""
        return {key[2:]: score.unit for key, score in self.found.items()}
