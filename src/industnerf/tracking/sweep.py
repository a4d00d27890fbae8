"""A sweep as a run of MLflow: below it a run per point and method."""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from industnerf.config import flatten, read_yaml
from industnerf.tracking.report import Report
from industnerf.tracking.run import Run
from industnerf.tracking.study import method_run

MARK = "multirun.yaml"  # which Hydra writes into the folder of a sweep
FILES = (MARK, "sweep.csv", "steps.csv", "trend.csv", "sweep.png")


def sweep_run(folder: Path) -> Run | None:
    """The run of the sweep in `folder`, of as many points as are finished; None if none is."""
    finished = folder.glob("*/reports/scores.csv")
    folders = sorted((path.parents[1] for path in finished), key=lambda point: int(point.name))
    if not folders:
        return None
    points = [Report(path / "reports", read_yaml(path / "params.yaml")) for path in folders]
    values = [flatten(point.params) for point in points]
    swept = [key for key in values[0] if len({str(point.get(key)) for point in values}) > 1]
    shared = {key: value for key, value in values[0].items() if key not in swept}
    first = points[0].tags
    return Run(
        f"{first['preset']}: {', '.join(swept) or 'one point'}",
        {
            **{name: first[name] for name in ("preset", "commit", "dirty") if name in first},
            "kind": "sweep",
            "folder": str(folder.absolute()),
            "view": _digest(str(folder.absolute()))[:8],
            "swept": " ".join(dict.fromkeys(map(own_name, swept))),
            "results": _digest(*(point.results + point.tags.get("point", "") for point in points)),
        },
        {key: value for key, value in shared.items() if not key.startswith("method.")},
        artifacts=(
            *((folder / name, "") for name in FILES if (folder / name).exists()),
            *((path / "reports", f"points/{path.name}") for path in folders),
        ),
        children=_point_runs(points, values, swept),
    )


def _digest(*texts: str) -> str:
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()


def _point_runs(
    points: Sequence[Report], values: Sequence[Mapping[str, Any]], swept: Sequence[str]
) -> Iterator[Run]:
    for point, flat in zip(points, values, strict=True):
        for method in point.methods():
            at_point = {own_name(key): flat.get(key) for key in swept if _concerns(key, method)}
            yield method_run(point, method, {"kind": "point"}, at_point)


def _concerns(key: str, method: str) -> bool:
    return not key.startswith("method.") or key.startswith(f"method.{method}.")


def own_name(key: str) -> str:
    """The parameter `key` as runs of methods name it: without `method.<name>.`."""
    return key.split(".", 2)[-1] if key.startswith("method.") else key
