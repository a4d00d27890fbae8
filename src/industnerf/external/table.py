"""What clouds from outside score, and the published study's methods on the same parts."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from industnerf.artifacts.part import Part
from industnerf.artifacts.scores import PartScore, Score
from industnerf.report.statistics.comparisons import TESTED_METHODS
from industnerf.report.statistics.significance import bootstrap_interval, paired_change
from industnerf.report.tables.formats import (
    format_fixed,
    format_interval,
    format_significant,
    read_csv,
)
from industnerf.report.tables.scores import EMD_EVEN
from industnerf.schema import ReportParams

COLUMNS = ("part", "EMD", "x floor", "EMD, mm", "95 %, mm", "in 0.5 mm")
LEGEND = (
    "EMD: how far points are moved on average to match the true surface, in diagonals of the "
    "part's box, and in mm\n"
    "x floor: as a multiple of the EMD of a perfect cloud\n"
    "95 %: the distance within which 95 % of points are, of cloud and surface, the larger\n"
    "in 0.5 mm: the share of the cloud within 0.5 mm of the surface"
)
STUDY_METHODS = (*TESTED_METHODS, "carve", "hull")  # of the study, beside what is asked about
OUTSIDE_STUDY = "outside the study"
Values = dict[str, dict[str, float]]  # method -> part -> EMD (even)


@dataclass(frozen=True)
class PublishedScores:
    """What the published study says of the parts that are asked about."""

    splits: dict[str, str]  # part -> dev or test
    values: Values


def load_published_scores(study: Path, methods: Sequence[str] = STUDY_METHODS) -> PublishedScores:
    """Read the published `scores.csv` of the folder `study`."""
    splits: dict[str, str] = {}
    values: Values = {method: {} for method in methods}
    for row in read_csv(study / "scores.csv"):
        splits[row["part_id"]] = row["split"]
        if row["method"] in values and (row["metric"], row["protocol"]) == EMD_EVEN:
            values[row["method"]][row["part_id"]] = float(row["value"])
    return PublishedScores(splits, values)


def part_rows(scores: Sequence[PartScore], parts: dict[str, Part]) -> list[list[str]]:
    """A line a part, as COLUMNS has it."""
    scores_by_part: dict[str, dict[tuple[str, str], Score]] = {}
    for row in scores:
        scores_by_part.setdefault(row.part_id, {})[row.score.metric, row.score.protocol] = row.score
    return [_row(parts[part], part_scores) for part, part_scores in sorted(scores_by_part.items())]


def _row(part: Part, scores: dict[tuple[str, str], Score]) -> list[str]:
    even, within = (
        scores[EMD_EVEN],
        scores.get(("within_0.5mm", "P1-dense")),
    )  # where params.yaml asks for it
    return [
        part.part_id if even.status == "ok" else f"{part.part_id}\nfailed",
        format_fixed(even.value),
        format_fixed(even.value / even.floor, 2),
        format_significant(even.value * part.diagonal_mm),
        format_significant(scores["hausdorff95", "P1-dense"].value),
        f"{100 * within.value:.0f} %" if within else "",
    ]


def summary(
    scores: Sequence[PartScore],
    parts: dict[str, Part],
    published: PublishedScores,
    config: ReportParams,
    seed: int,
) -> list[str]:
    """A paragraph for the test parts, the dev parts, and those that the study does not have."""
    even = {r.part_id: r.score for r in scores if (r.score.metric, r.score.protocol) == EMD_EVEN}
    groups: dict[str, dict[str, Score]] = {}
    for part_id, score in even.items():
        groups.setdefault(published.splits.get(part_id, OUTSIDE_STUDY), {})[part_id] = score
    families = {part_id: parts[part_id].family for part_id in even}
    return [
        "\n".join(_paragraph(split, groups[split], families, published, config, seed))
        for split in ("test", "dev", OUTSIDE_STUDY)
        if split in groups
    ]


def _paragraph(
    split: str,
    scores: dict[str, Score],
    families: dict[str, str],
    published: PublishedScores,
    config: ReportParams,
    seed: int,
) -> list[str]:
    values = {part: score.value for part, score in scores.items()}
    part_families = [families[part] for part in values]
    low, high = bootstrap_interval(list(values.values()), part_families, config, seed)
    interval = _interval(low, high, ".4f")
    mean, floor = fmean(values.values()), fmean(score.floor for score in scores.values())
    failed = sum(score.status != "ok" for score in scores.values())
    split_size = sum(other_split == split for other_split in published.splits.values())
    count = f"{len(values)} of {split_size}" if split_size else str(len(values))
    lines = [
        f"{split}: {count} parts of {len(set(part_families))} families, {failed} failed",
        f"  EMD (even) {mean:.4f}{interval}, {mean / floor:.2f} x floor",
    ]
    for method, study_values in published.values.items():
        change = paired_change(study_values, values, families, config, seed)
        if change is not None:
            shared_parts = values.keys() & study_values.keys()
            study_mean = fmean(study_values[part] for part in shared_parts)
            change_interval = _interval(change.low, change.high, "+.4f")
            lines.append(
                f"  {method} {study_mean:.4f} on these: {change.mean:+.4f}{change_interval}, "
                f"lower on {change.num_lower} of {change.parts}"
            )
    return lines


def _interval(low: float | None, high: float | None, form: str) -> str:
    """In brackets, where there is one."""
    text = format_interval(low, high, form)
    return f" ({text})" if text else ""
