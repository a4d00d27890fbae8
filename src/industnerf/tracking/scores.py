"""The scores and costs of a report as MLflow shows them: under the same names for every method."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

# Of a metric that is measured in several ways the one that the tables name first has no suffix.
MAIN_VARIANTS = ("even", "dense", "union", "near")
MAIN = ("emd", "emd_ratio", "seconds", "peak_mb", "chamfer", "fscore")
INDEX = ["method", "scope", "split", "family", "part_id"]
TABLE1_NAMES = {  # column of table1.csv: name in MLflow
    "ci_low": "emd_ci_low",
    "ci_high": "emd_ci_high",
    "emd_mm": "emd_mm",
    "seeds_sd": "emd_seeds_sd",
    "parameters": "parameters",
    "steps": "steps",
}


def metric_name(metric: str, protocol: str) -> str:
    """The name of a score: `emd` of P1-even, `emd_iid` of P1-iid."""
    variant = protocol.rpartition("-")[2]
    return metric if variant in MAIN_VARIANTS else f"{metric}_{variant}"


def read_part_scores(report: Path) -> Any:
    """A data frame with a row per method and part, sorted by family, and a column per metric.

    Beside the metrics `floor` and `emd_ratio` of the EMD, `status`, and `seconds` and `peak_mb` of
    the reconstruction; NaN where something is not known.
    """
    import pandas as pd

    scores = pd.read_csv(report / "scores.csv")
    name = [metric_name(*key) for key in zip(scores.metric, scores.protocol, strict=True)]
    scores = scores.assign(name=name)
    table = scores.pivot(index=INDEX, columns="name", values="value")
    emd = scores[scores.name == "emd"].set_index(INDEX)
    table = table.assign(
        floor=emd.floor,
        emd_ratio=emd.value / emd.floor,
        status=scores.groupby(INDEX).status.min(),  # failed, if anything did, comes before ok
    )
    costs = read_costs(report, "reconstruct")[["method", "part_id", "seconds", "peak_mb"]]
    return table.reset_index().merge(costs, how="left", on=["method", "part_id"])


def read_costs(report: Path, stage: str) -> Any:
    """The rows of cost.csv of one stage; `seconds` of the processor, by the clock in older ones."""
    import pandas as pd

    costs = pd.read_csv(report / "cost.csv")
    if "cpu_seconds" in costs:
        costs["seconds"] = costs.cpu_seconds.fillna(costs.seconds)
    return costs[costs.stage == stage]


def read_table1(report: Path) -> Any:
    """Table 1 as a data frame, the method of the smallest EMD first."""
    import pandas as pd

    return pd.read_csv(report / "table1.csv")


def mean_scores(rows: Any) -> dict[str, float]:
    """The means over `rows` of `read_part_scores`, all of one method.

    Six digits, and `emd_ratio` that of the means, as in Table 1; `peak_mb` is the largest.
    """
    means = rows.drop(columns=[*INDEX, "status"]).mean()
    means["emd_ratio"] = means["emd"] / means["floor"]
    means["peak_mb"] = rows.peak_mb.max()
    means["failures"] = (rows.status != "ok").sum()
    means["parts"], means["families"] = len(rows), rows.family.nunique()
    return {name: float(f"{value:.6g}") for name, value in _first(means.dropna(), MAIN).items()}


def _first(table: Any, names: Sequence[str]) -> Any:
    """`table` with the entries or columns `names` before the others: MLflow shows those first."""
    first = [name for name in names if name in table]
    return table[[*first, *table.keys().difference(first, sort=False)]]


def part_table(*rows: Any) -> Any:
    """All `rows` of one method as JSON can hold them: None where something is not known.

    `step` is where the parts that come first stand in the charts.
    """
    import pandas as pd

    table = pd.concat(rows).drop(columns=["method", "scope"])
    table["step"] = range(len(table))
    table = _first(table.dropna(axis="columns", how="all"), ("part_id", *MAIN))
    return table.astype(object).where(table.notna(), None)
