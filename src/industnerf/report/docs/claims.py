"""docs/results/claims.md: what the paper claims, and what the published results say of it."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean

from industnerf.report import paper_results
from industnerf.report.docs.study_results import mean_seconds
from industnerf.report.tables.costs import seconds_label
from industnerf.report.tables.formats import (
    format_interval,
    markdown_table,
    optional_float,
    read_csv,
)
from industnerf.report.tables.goals import (
    AUSE_SHARE,
    CONFIDENCE_CORRELATION,
    MAX_CORRELATION,
    MEMORY,
)
from industnerf.report.tables.scores import EMD_EVEN, SPEARMAN

HOLDS, FAILS, UNDECIDED = "holds", "does not hold", "cannot be told"
BASELINES = {method: name for method, name in paper_results.MODELS.items() if name != "Ours"}
CLASSICAL = {"hull": "the visual hull", "carve": "space carving"}
HEADS = ("section", "claim", "verdict", "measured")
METHOD = paper_results.METHOD
REAL_TIME_SECONDS = 1.0
FOUR_PARTS_RESOLUTION = 0.002  # smaller differences of EMD on four parts prove nothing

CsvRow = dict[str, str]


@dataclass(frozen=True)
class Claim:
    """One claim, and what is measured of it."""

    section: str
    text: str
    verdict: str
    measured: str

    def cells(self) -> tuple[str, ...]:
        """One for each of HEADS."""
        return self.section, self.text, f"**{self.verdict}**", self.measured


def claims_block(study: Path, sweeps: Path) -> str:
    """Three tables: the paper's claims, what it does not compare with, and its limitations.

    `study` is a folder of published results beside that of the organic set, `sweeps` that of the
    published sweeps.
    """
    claims = [
        *_baseline_claims(study, BASELINES),
        *_family_claim(study),
        *_view_claim(sweeps / "sweep-views" / "steps.csv"),
        *_confidence_claim(study),
        *_unsupervised_claim(study),
        *_number_claim(study),
    ]
    tables = [
        markdown_table(HEADS, [claim.cells() for claim in group])
        for group in (
            claims,
            [*_baseline_claims(study, CLASSICAL)],
            [*_cost_limits(study, sweeps), *_organic_limit(study), *_noise_limit(sweeps)],
        )
    ]
    return (
        f"{tables[0]}\nWhat the paper does not compare with:\n\n{tables[1]}\n"
        f"Limitations that the paper names (5.1) and does not measure:\n\n{tables[2]}"
    )


def verdict_of(low: float | None, high: float | None) -> str:
    """The verdict on "less": by whether the interval of a difference lies below or above 0.

    Without an interval, as of one family, nothing can be told.
    """
    if low is None or high is None:
        return UNDECIDED
    if high < 0:
        return HOLDS
    return FAILS if low > 0 else UNDECIDED


def difference_text(row: CsvRow) -> str:
    """Such as `-0.0060 (-0.0080 to -0.0040), better on 90 % of the parts`."""
    interval = format_interval(*_interval(row), "+.4f")
    return (
        f"{float(row['difference']):+.4f}{f' ({interval})' if interval else ''}, "
        f"better on {100 * float(row['win_rate']):.0f} % of the parts"
    )


def _views(row: CsvRow) -> str:
    return "one view" if row["views"] == "1" else f"{row['views']} views"


def _interval(row: CsvRow) -> tuple[float | None, float | None]:
    return optional_float(row["ci_low"]), optional_float(row["ci_high"])


def _baseline_claims(study: Path, others: Mapping[str, str]) -> Iterator[Claim]:
    """4.6.1, by the paired differences of EMD."""
    rows = {(row["method"], row["other"]): row for row in read_csv(study / "comparisons.csv")}
    table = _table1(study)
    for other, name in others.items():
        if row := rows.get((METHOD, other)):
            measured = f"EMD {difference_text(row)}"
            mark = "; it is undertrained here" if table[other]["undertrained"] else ""
            if other in BASELINES:
                mark = f"; it answers from {_views(table[other])}{mark}"
            section = "4.6.1" if other in BASELINES else ""
            verdict = verdict_of(*_interval(row))
            yield Claim(section, f"better than {name}", verdict, measured + mark)


def _family_claim(study: Path) -> Iterator[Claim]:
    """4.6.2: "consistent" beside the baselines, so better than each of them in every family."""
    means = _family_means(study)
    baselines = [name for name in BASELINES if name in means]
    if METHOD not in means or not baselines:
        return
    own = means[METHOD]
    won = [family for family in own if all(own[family] < means[name][family] for name in baselines)]
    yield Claim(
        "4.6.2",
        "better than the baselines in every category of objects",
        HOLDS if len(won) == len(own) else FAILS,
        f"better than {', '.join(BASELINES[name] for name in baselines)} in {len(won)} of "
        f"{len(own)} families; its own EMD is {min(own.values()):.4f} to "
        f"{max(own.values()):.4f} by family",
    )


def _family_means(study: Path) -> dict[str, dict[str, float]]:
    """Method -> family -> mean EMD (even) of the test parts."""
    values: dict[str, dict[str, list[float]]] = defaultdict(lambda: defaultdict(list))
    for row in _test_scores(study, EMD_EVEN):
        values[row["method"]][row["family"]].append(float(row["value"]))
    return {
        method: {family: fmean(emds) for family, emds in families.items()}
        for method, families in values.items()
    }


def _test_scores(study: Path, metric: tuple[str, str]) -> Iterator[CsvRow]:
    """Those of the test parts by all methods; `metric`: its name and protocol."""
    for row in read_csv(study / "scores.csv"):
        if row["split"] == "test" and (row["metric"], row["protocol"]) == metric:
            yield row


def _view_claim(steps: Path) -> Iterator[Claim]:
    """3.4, by the paired differences of EMD from fewer to more views."""
    rows = [row for row in read_csv(steps) if row["series"] == METHOD] if steps.exists() else []
    if rows:
        verdicts = {verdict_of(*_interval(row)) for row in rows}
        verdict = verdicts.pop() if len(verdicts) == 1 else UNDECIDED
        measured = ", ".join(
            f"{row['from']} to {row['to']} views {float(row['EMD changes by']):+.4f}"
            for row in rows
        )
        text = f"more input views, more precision (up to {rows[-1]['to']} views)"
        yield Claim("3.4", text, verdict, f"EMD: {measured}")


def _confidence_claim(study: Path) -> Iterator[Claim]:
    """3.4: a confidence that can be interpreted is higher where the error is smaller.

    The bounds are those of the goals.
    """
    goals = _goals(study)
    if CONFIDENCE_CORRELATION in goals:
        correlation, share = goals[CONFIDENCE_CORRELATION], goals[AUSE_SHARE]
        of_parts = [
            float(row["value"]) for row in _test_scores(study, SPEARMAN) if row["method"] == METHOD
        ]
        num_good = sum(value <= MAX_CORRELATION for value in of_parts)
        yield Claim(
            "3.4",
            "confidences can be interpreted",
            HOLDS if correlation <= MAX_CORRELATION and share < 1 else UNDECIDED,
            f"rank correlation with the error {correlation:.2f}, {MAX_CORRELATION} or lower on "
            f"{num_good} of {len(of_parts)} parts; AUSE is {share:.2f} of that of a random order",
        )


def _unsupervised_claim(study: Path) -> Iterator[Claim]:
    row = _table1(study).get(METHOD)
    if row:
        parts = int(row["num_train_parts"])
        yield Claim(
            "3",
            "unsupervised",
            FAILS if parts else HOLDS,
            f"learns from {parts or 'no'} other parts; is given: {row['inputs']}, and the cameras",
        )


def _number_claim(study: Path) -> Iterator[Claim]:
    """The paper's own EMD, which has no protocol that could be repeated."""
    row = _table1(study).get(METHOD)
    if row:
        yield Claim(
            "Table 1",
            f"an EMD of {paper_results.EMD[METHOD]:.4f}",
            UNDECIDED,
            f"{float(row['emd_even']):.4f} here, {float(row['ratio_to_floor']):.2f} floors; the "
            "paper states no protocol, no number of points and no data",
        )


def _cost_limits(study: Path, sweeps: Path) -> Iterator[Claim]:
    """Time and memory of one part, and how they grow with its faces."""
    memory, seconds = _goals(study).get(MEMORY), mean_seconds(study).get(METHOD)
    if memory is not None and seconds is not None:
        yield Claim(
            "5.1",
            "not fit for real time",
            HOLDS if seconds > REAL_TIME_SECONDS else FAILS,
            f"{seconds:.0f} {seconds_label(read_csv(study / 'cost.csv'))} a part, "
            f"at most {memory:.1f} GB",
        )
    trend = sweeps / "sweep-complexity" / "trend.csv"
    for row in read_csv(trend) if trend.exists() else []:
        if (row["series"], row["quantity"]) == (METHOD, "seconds"):
            exponent, error = float(row["exponent"]), float(row["standard error"])
            yield Claim(
                "5.1",
                "cost may grow faster than linearly with complexity",
                verdict_of(*(1 - exponent + side * 1.96 * error for side in (-1, 1))),
                f"seconds grow by the {exponent:.2f}th power (standard error {error:.2f}) of the "
                f"faces, over {row['points']} parts",
            )


def _organic_limit(study: Path) -> Iterator[Claim]:
    """Whether it is farther from its floor on organic shapes than on industrial parts."""
    organic = study.with_name("organic")
    rows = [_table1(folder).get(METHOD) for folder in (study, organic) if folder.exists()]
    if len(rows) == 2 and all(rows):
        industrial, other = (float(row["ratio_to_floor"]) for row in rows if row)
        parts = rows[1]["parts"] if rows[1] else ""
        yield Claim(
            "5.1",
            "worse on shapes that are not industrial",
            UNDECIDED,
            f"{other:.2f} floors on the organic set of {parts} parts, {industrial:.2f} on the "
            "study's; too few families for an interval",
        )


def _noise_limit(sweeps: Path) -> Iterator[Claim]:
    """EMD with the strongest noise against none: too few parts for an interval."""
    path = sweeps / "sweep-noise-nerf" / "sweep.csv"
    rows = [row for row in read_csv(path) if row["method"] == METHOD] if path.exists() else []
    if rows:
        clean, noisy = (float(row["emd"]) for row in (rows[0], rows[-1]))
        is_clear = abs(noisy - clean) > FOUR_PARTS_RESOLUTION
        yield Claim(
            "5.1",
            "sensitive to noise in the images",
            (HOLDS if noisy > clean else FAILS) if is_clear else UNDECIDED,
            f"EMD {clean:.4f} without, {noisy:.4f} with a standard deviation of "
            f"{rows[-1]['views.sensor.noise']}, on four dev parts, which show no difference below "
            f"{FOUR_PARTS_RESOLUTION}",
        )


def _table1(study: Path) -> dict[str, CsvRow]:
    return {row["method"]: row for row in read_csv(study / "table1.csv") if row["split"] == "test"}


def _goals(study: Path) -> dict[str, float]:
    """The values of the goals of the paper's method, by what is measured."""
    rows: Sequence[CsvRow] = read_csv(study / "goals.csv")
    return {row["goal"]: float(row["value"]) for row in rows if row["method"] == METHOD}
