"""Tables, contact sheet and one page that opens offline.  DVC stage `report`."""

import sys
from pathlib import Path

from industnerf.cli import run_as_stage
from industnerf.config import PARAMS, Masked, read_yaml
from industnerf.report.build import build_report
from industnerf.report.costs import CostRow, add_cost
from industnerf.report.gather import About, Folders, gather
from industnerf.report.spread_shown import with_spread
from industnerf.stage import measured
from industnerf.tracking import label, log_report


def main(
    cfg: Masked,
    solids: str,
    parts: str,
    views: str,
    split: str,
    truth: str,
    states: str,
    clouds: str,
    scores: str,
    grid: str,
    seeds: str,
    out: str,
) -> None:
    folders = map(Path, (solids, parts, views, split, truth, states, clouds, scores))
    count = cfg.reconstruct.views or cfg.views.count
    about = About(cfg.preset, cfg.seed, count, cfg.split.hold_out, cfg.methods, cfg.method)

    def build(to: Path) -> None:
        study = with_spread(gather(Folders(*folders), about), Path(seeds))
        build_report(study, cfg.report, Path(grid), to)

    cost = measured(build, Path(out))
    add_cost(Path(out) / "cost.csv", CostRow("report", "", "", cost))
    label(Path(out))


if __name__ == "__main__":
    run_as_stage(main, "report")
    log_report(Path(sys.argv[-1]), read_yaml(PARAMS))
