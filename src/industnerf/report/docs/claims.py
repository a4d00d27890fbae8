"""docs/results/claims.md: what the paper claims, and what the published results say of it."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
from statistics import fmean

from industnerf.config import build, read_yaml
from industnerf.report import paper_results
from industnerf.report.docs.claim import (
    FAILS,
    HEADS,
    HOLDS,
    METHOD,
    UNDECIDED,
    Claim,
    CsvRow,
    goal_values,
    interval_of,
    verdict_of,
)
from industnerf.report.docs.limitations import cost_limits, noise_limit, organic_limit
from industnerf.report.docs.study_results import mean_seconds, test_rows_by_method
from industnerf.report.statistics.significance import bootstrap_interval
from industnerf.report.tables.costs import seconds_label
from industnerf.report.tables.formats import (
    format_interval,
    markdown_table,
    read_csv,
)
from industnerf.report.tables.goals import AUSE_SHARE, MAX_CORRELATION
from industnerf.report.tables.scores import EMD_EVEN, SPEARMAN
from industnerf.schema import ReportParams

BASELINES = {method: name for method, name in paper_results.MODELS.items() if name != "Ours"}
CLASSICAL = {"hull": "the visual hull", "carve": "space carving"}


def claims_block(study: Path, sweeps: Path) -> str:
    """Three tables: the paper's claims, what it does not compare with, and its limitations.

    `study` is a folder of published results beside that of the organic set, `sweeps` that of the
    published sweeps.
    """
    claims = [
        *_baseline_claims(study, BASELINES),
        *_family_claims(study),
        *_speed_claim(study),
        *_generalization_claim(study),
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
            [*cost_limits(study, sweeps), *organic_limit(study), *noise_limit(sweeps)],
        )
    ]
    return (
        f"{tables[0]}\nWhat the paper does not compare with:\n\n{tables[1]}\n"
        f"Limitations that the paper names (5.1) and does not measure:\n\n{tables[2]}"
    )


def difference_text(row: CsvRow) -> str:
    """Such as `-0.0060 (-0.0080 to -0.0040), better on 90 % of the parts`."""
    interval = format_interval(*interval_of(row), "+.4f")
    return (
        f"{float(row['difference']):+.4f}{f' ({interval})' if interval else ''}, "
        f"better on {100 * float(row['win_rate']):.0f} % of the parts"
    )


def _views(row: CsvRow) -> str:
    return "one view" if row["views"] == "1" else f"{row['views']} views"


def _baseline_claims(study: Path, others: Mapping[str, str]) -> Iterator[Claim]:
    """4.6.1, by the paired differences of EMD."""
    rows = {(row["method"], row["other"]): row for row in read_csv(study / "comparisons.csv")}
    table = test_rows_by_method(study)
    for other, name in others.items():
        if row := rows.get((METHOD, other)):
            measured = f"EMD {difference_text(row)}"
            mark = "; it is undertrained here" if table[other]["undertrained"] else ""
            if other in BASELINES:
                mark = f"; it answers from {_views(table[other])}{mark}"
            section = "4.6.1" if other in BASELINES else ""
            verdict = verdict_of(*interval_of(row), int(row["families"]))
            yield Claim(section, f"better than {name}", verdict, measured + mark)


def _family_claims(study: Path) -> Iterator[Claim]:
    """4.6.2: better than the baselines, and "consistent", in every family."""
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
        f"{len(own)} families",
    )
    yield Claim(
        "4.6.2",
        "consistent quality across categories of objects",
        UNDECIDED,
        f"its EMD is {min(own.values()):.4f} to {max(own.values()):.4f} by family; the paper "
        "does not say how much may differ",
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


def _speed_claim(study: Path) -> Iterator[Claim]:
    """The abstract: faster than each baseline answers, without what trained it."""
    seconds = mean_seconds(study)
    others = {name: seconds[method] for method, name in BASELINES.items() if method in seconds}
    if METHOD in seconds and others:
        yield Claim(
            "abstract",
            "faster than the baselines",
            HOLDS if seconds[METHOD] < min(others.values()) else FAILS,
            f"{seconds[METHOD]:.0f} {seconds_label(read_csv(study / 'cost.csv'))} a part; "
            + ", ".join(f"{name} {value:.1f}" for name, value in others.items())
            + " when trained",
        )


def _generalization_claim(study: Path) -> Iterator[Claim]:
    """The abstract: the paired differences of EMD on shapes unlike all training parts."""
    organic = study.with_name("organic") / "comparisons.csv"
    rows = {
        BASELINES[row["other"]]: row
        for row in (read_csv(organic) if organic.exists() else [])
        if row["method"] == METHOD and row["other"] in BASELINES
    }
    if rows:
        differences = ", ".join(
            f"{name} {float(row['difference']):+.4f}" for name, row in rows.items()
        )
        families = min(int(row["families"]) for row in rows.values())
        verdicts = {verdict_of(*interval_of(row), families) for row in rows.values()}
        fewest = min(float(row["win_rate"]) for row in rows.values())
        yield Claim(
            "abstract",
            "generalizes better than the baselines",
            verdicts.pop() if len(verdicts) == 1 else UNDECIDED,
            f"EMD on the organic set less that of {differences}; better than each on "
            f"{100 * fewest:.0f} % of the parts or more; {families} families",
        )


def _view_claim(steps: Path) -> Iterator[Claim]:
    """3.4, by the paired differences of EMD from fewer to more views."""
    rows = [row for row in read_csv(steps) if row["series"] == METHOD] if steps.exists() else []
    if rows:
        verdicts = {verdict_of(*interval_of(row)) for row in rows}
        verdict = verdicts.pop() if len(verdicts) == 1 else UNDECIDED
        measured = ", ".join(
            f"{row['from']} to {row['to']} views {float(row['EMD changes by']):+.4f} "
            f"({format_interval(*interval_of(row), '+.4f')})"
            for row in rows
        )
        text = f"more input views, more precision (up to {rows[-1]['to']} views)"
        yield Claim("3.4", text, verdict, f"EMD: {measured}")


def _confidence_claim(study: Path) -> Iterator[Claim]:
    """3.4: a confidence that can be interpreted is higher where the error is smaller.

    The bounds are those of the goals.
    """
    rows = [row for row in _test_scores(study, SPEARMAN) if row["method"] == METHOD]
    share = goal_values(study).get(AUSE_SHARE)
    if rows and share is not None:
        params = read_yaml(study / "params.yaml")
        settings = build(ReportParams, params["report"], str(study / "params.yaml"))
        values, families = [float(row["value"]) for row in rows], [row["family"] for row in rows]
        low, high = bootstrap_interval(values, families, settings, params["seed"])
        is_high = high is not None and high <= MAX_CORRELATION
        interval = format_interval(low, high, ".2f")
        yield Claim(
            "3.4",
            "confidences can be interpreted",
            HOLDS if is_high and share < 1 else UNDECIDED,
            f"rank correlation with the error {fmean(values):.2f} ({interval}), {MAX_CORRELATION} "
            f"or lower on {sum(value <= MAX_CORRELATION for value in values)} of {len(values)} "
            f"parts; AUSE is {share:.2f} of that of a random order",
        )


def _unsupervised_claim(study: Path) -> Iterator[Claim]:
    row = test_rows_by_method(study).get(METHOD)
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
    row = test_rows_by_method(study).get(METHOD)
    if row:
        yield Claim(
            "Table 1",
            f"an EMD of {paper_results.EMD[METHOD]:.4f}",
            UNDECIDED,
            f"{float(row['emd_even']):.4f} here, {float(row['ratio_to_floor']):.2f} floors; the "
            "paper states no protocol, no number of points and no data",
        )
