"""What clouds from outside score, and the published study's methods on the same parts."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from industnerf.artifacts.part import Part
from industnerf.artifacts.scores import PartScore, Score
from industnerf.report.comparisons import TESTED
from industnerf.report.formats import brief, csv_rows, interval_text, short
from industnerf.report.lookup import EVEN
from industnerf.report.statistics import bootstrap_interval, paired_change
from industnerf.schema import ReportParams

HEADS = ("part", "EMD", "x floor", "mm", "H-95, mm", "within 0.5 mm", "")
BESIDE = (*TESTED, "carve", "hull")  # of the study, beside what is asked about
ASIDE = "outside the study"
Values = dict[str, dict[str, float]]  # method -> part -> EMD (even)


@dataclass(frozen=True)
class Known:
    """What the published study says of the parts that are asked about."""

    splits: dict[str, str]  # part -> dev or test
    values: Values


def known_of(study: Path, methods: Sequence[str] = BESIDE) -> Known:
    """Read the published `scores.csv` of the folder `study`."""
    splits: dict[str, str] = {}
    values: Values = {method: {} for method in methods}
    for row in csv_rows(study / "scores.csv"):
        splits[row["part_id"]] = row["split"]
        if row["method"] in values and (row["metric"], row["protocol"]) == EVEN:
            values[row["method"]][row["part_id"]] = float(row["value"])
    return Known(splits, values)


def part_lines(scores: Sequence[PartScore], parts: dict[str, Part]) -> list[list[str]]:
    """A line a part, as HEADS has it."""
    found: dict[str, dict[tuple[str, str], Score]] = {}
    for row in scores:
        found.setdefault(row.part_id, {})[row.score.metric, row.score.protocol] = row.score
    return [_line(parts[part], of) for part, of in sorted(found.items())]


def _line(part: Part, of: dict[tuple[str, str], Score]) -> list[str]:
    even, within = of[EVEN], of.get(("within_0.5mm", "P1-dense"))  # where params.yaml asks for it
    return [
        part.part_id,
        short(even.value),
        short(even.value / even.floor, 2),
        brief(even.value * part.diagonal_mm),
        brief(of["hausdorff95", "P1-dense"].value),
        f"{100 * within.value:.0f} %" if within else "",
        "" if even.status == "ok" else "failed",
    ]


def summary(
    scores: Sequence[PartScore],
    parts: dict[str, Part],
    known: Known,
    ways: ReportParams,
    seed: int,
) -> list[str]:
    """A paragraph for the test parts, the dev parts, and those that the study does not have."""
    even = {r.part_id: r.score for r in scores if (r.score.metric, r.score.protocol) == EVEN}
    groups: dict[str, dict[str, Score]] = {}
    for part_id, score in even.items():
        groups.setdefault(known.splits.get(part_id, ASIDE), {})[part_id] = score
    families = {part_id: parts[part_id].family for part_id in even}
    return [
        "\n".join(_paragraph(split, groups[split], families, known, ways, seed))
        for split in ("test", "dev", ASIDE)
        if split in groups
    ]


def _paragraph(
    split: str,
    scores: dict[str, Score],
    families: dict[str, str],
    known: Known,
    ways: ReportParams,
    seed: int,
) -> list[str]:
    values = {part: score.value for part, score in scores.items()}
    of = [families[part] for part in values]
    interval = _interval(*bootstrap_interval(list(values.values()), of, ways, seed), of, ".4f")
    mean, floor = fmean(values.values()), fmean(score.floor for score in scores.values())
    failed = sum(score.status != "ok" for score in scores.values())
    all_of_it = sum(one == split for one in known.splits.values())
    count = f"{len(values)} of {all_of_it}" if all_of_it else str(len(values))
    lines = [
        f"{split}: {count} parts of {len(set(of))} families, {failed} failed",
        f"  EMD (even) {mean:.4f}{interval}, {mean / floor:.2f} x floor",
    ]
    for method, theirs in known.values.items():
        change = paired_change(theirs, values, families, ways, seed)
        if change is not None:
            both = values.keys() & theirs.keys()
            level = fmean(theirs[part] for part in both)
            drawn_from = [families[part] for part in both]
            spread = _interval(change.low, change.high, drawn_from, "+.4f")
            lines.append(
                f"  {method} {level:.4f} on these: {change.mean:+.4f}{spread}, lower on "
                f"{change.lower} of {change.parts}"
            )
    return lines


def _interval(low: float, high: float, families: Sequence[str], form: str) -> str:
    """In brackets, where there is one."""
    text = interval_text(low, high, len(set(families)), form)
    return f" ({text})" if text else ""
