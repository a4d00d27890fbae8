"""A small report, and whether what is published agrees with the scores published beside it."""

import csv
from math import isclose
from pathlib import Path
from statistics import fmean

import numpy as np

from industnerf.artifacts.scores import PartScore, Score
from industnerf.report.build import write_tables
from industnerf.report.publish.study_folder import RUN_FILES, publish_study
from industnerf.report.results import Results
from industnerf.report.statistics.comparisons import TESTED_METHODS
from industnerf.report.statistics.significance import holm_correction, sign_flip_p
from industnerf.report.study import Study
from tests.report.publish.test_downsample_images import png
from tests.samples import unit_part
from tests.studies import SETTINGS, make_study

PARAMS_YAML = "seed: 0\nviews: {count: 40, fov_deg: 30.0, sky: {x: {p: 1}}}\n"  # params.yaml
PROVENANCE = {
    "schema": 1,
    "command": "make repro",
    "date": "2026-01-02",
    "commit": "0123456789abcdef",
    "clean": True,
    "changed": [],
    "preset": "study",
    "interval": 0.9,
}
NAMES, FAMILIES = "abcdefg", "ffghijk"


def small_study() -> Study:
    """Six test parts of five families, and the dev part g; a method renders, and one fails once."""
    parts = [
        unit_part(name, family, strata=("pockets",) if name in "abc" else ())
        for name, family in zip(NAMES, FAMILIES, strict=True)
    ]
    draws = np.random.default_rng(0)
    names = ("industnerf_plus", "industnerf", "hull", "oracle")
    emds = {name: draws.uniform(0.01, 0.2, 7).tolist() for name in names}
    emds["hull"][2] = float("inf")
    study = make_study(parts, emds, dev="g")
    for name in NAMES:
        for metric in ("rgb_mse", "depth_mse"):
            score = Score(metric, "P1-union", draws.uniform(0.01, 0.2), 0.0, "1", "ok")
            study.scores.append(PartScore(name, "industnerf", score))
    return study


def write_report(folder: Path) -> Path:
    """What the report stage writes of `small_study`, but the page."""
    study = small_study()
    folder.mkdir(parents=True, exist_ok=True)
    write_tables(Results.from_study(study, SETTINGS), folder)
    (folder / "cost.csv").write_text(
        "stage,method,part_id,seconds,peak_mb,device,extra_seconds\n"
        "reconstruct,hull,a,1.0,5,cpu,0\nreconstruct,hull,b,2.0,5,cpu,0\n"
        "reconstruct,hull,g,9.0,5,cpu,0\nevaluate,hull,a,9.0,5,cpu,0\n"
    )
    (folder / "origins.md").write_text("All results were made on one machine.\n")
    (folder / "contact_sheet.png").write_bytes(png(np.zeros((30, 40, 3), np.uint8)))
    return folder


def publish_report(project: Path) -> Path:
    """`write_report` as `publish_study` leaves it; returns the folder of the results."""
    report, out = write_report(project / "reports"), project / "results" / "study"
    for name, _ in RUN_FILES.values():
        (project / name).write_text(PARAMS_YAML)
    publish_study(report, out, PROVENANCE, project)
    return out


def read_rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def disagreements(folder: Path) -> list[str]:
    """Each number in the tables of `folder` that is not what its scores.csv makes of it."""
    scores = read_rows(folder / "scores.csv")
    expected = {
        "table1.csv": [(row, _table1(row, scores)) for row in read_rows(folder / "table1.csv")],
        "table2.csv": [
            (row, {"value": _mean(_select(scores, row["method"], row["loss"]))})
            for row in read_rows(folder / "table2.csv")
            if row["subset"] == "all" and not row["unit"].startswith("mm")
        ],
        "strata.csv": [
            (row, _stratum(row, scores))
            for row in read_rows(folder / "strata.csv")
            if row["stratum"] == "all"
        ],
        "comparisons.csv": _comparisons(read_rows(folder / "comparisons.csv"), scores),
    }
    return [
        f"{name}: {list(row.values())[:3]} {column} is {row[column]}, the scores say {value}"
        for name, pairs in expected.items()
        for row, values in pairs
        for column, value in values.items()
        # six decimals in table1.csv, six digits elsewhere
        if not isclose(float(row[column]), value, rel_tol=6e-6, abs_tol=6e-7)
    ]


def _select(scores, method, metric="emd", split="test", protocol=None):
    protocol = protocol or ("P1-even" if metric == "emd" else "P1-union")
    key = (method, metric, split, protocol)
    return [
        row
        for row in scores
        if (row["method"], row["metric"], row["split"], row["protocol"]) == key
    ]


def _mean(rows, column="value"):
    return fmean(float(row[column]) for row in rows)


def _table1(row, scores):
    even_scores = _select(scores, row["method"], split=row["split"])
    others = {
        f"emd_{name}": _mean(_select(scores, row["method"], "emd", row["split"], f"P1-{name}"))
        for name in ("even", "iid", "full")
    }
    return others | {
        "floor": _mean(even_scores, "floor"),
        "ratio_to_floor": _mean(even_scores) / _mean(even_scores, "floor"),
        "parts": len(even_scores),
        "failures": sum(score["status"] != "ok" for score in even_scores),
    }


def _stratum(row, scores):
    even_scores = _select(scores, row["method"])
    return {
        "emd_even": _mean(even_scores),
        "floor": _mean(even_scores, "floor"),
        "parts": len(even_scores),
    }


def _comparisons(rows, scores):
    families = (
        [row for row in rows if row["method"] in TESTED_METHODS],
        [row for row in rows if row["method"] not in TESTED_METHODS],
    )
    return [pair for family in families for pair in _corrected(family, scores)]


def _corrected(rows, scores):
    results = [_comparison(row, scores) for row in rows]
    adjusted = holm_correction([values["p"] for values in results])
    return [
        (row, values | {"p_holm": p})
        for row, values, p in zip(rows, results, adjusted, strict=True)
    ]


def _comparison(row, scores):
    own_scores, other_scores = (
        {score["part_id"]: float(score["value"]) for score in _select(scores, row[name])}
        for name in ("method", "other")
    )
    family = {score["part_id"]: score["family"] for score in scores}
    differences = [own_scores[part] - other_scores[part] for part in own_scores]
    families = [family[part] for part in own_scores]
    return {
        "difference": fmean(differences),
        "p": sign_flip_p(differences, families, np.random.default_rng(0)),
        "win_rate": fmean(difference < 0 for difference in differences),
        "parts": len(differences),
        "families": len(set(families)),
    }
