"""Tables, contact sheet and one page that opens offline.  DVC stage `report`."""

import sys
from pathlib import Path

from industnerf import environment
from industnerf.cli import run_as_stage
from industnerf.config import PARAMS, StageParams, read_yaml
from industnerf.report.build import build_report
from industnerf.report.statistics.seed_variance import add_seed_variance
from industnerf.report.study import RunMetadata, StudyFolders, load_study
from industnerf.report.tables.costs import CostRow, add_cost
from industnerf.report.terminal_summary import SUMMARY, print_summary
from industnerf.stage import run_timed
from industnerf.tracking import log_report, save_tags


def main(
    cfg: StageParams,
    solids: str,
    parts: str,
    views: str,
    split: str,
    truth: str,
    procedural: str,
    states: str,
    clouds: str,
    scores: str,
    grid: str,
    seeds: str,
    out: str,
) -> None:
    folders = map(Path, (solids, parts, views, split, truth, procedural, states, clouds, scores))
    num_views = cfg.reconstruct.views or cfg.views.count
    metadata = RunMetadata(
        cfg.preset, cfg.seed, num_views, cfg.split.hold_out, cfg.methods, cfg.method
    )

    def build(target: Path) -> None:
        study = add_seed_variance(load_study(StudyFolders(*folders), metadata), Path(seeds))
        build_report(study, cfg.report, Path(grid), target)

    cost = run_timed(build, Path(out))
    add_cost(Path(out) / "cost.csv", CostRow("report", "", "", cost))
    save_tags(Path(out))
    if environment.get_str(SUMMARY) != "off":
        print_summary(Path(out), Path(out).absolute())


if __name__ == "__main__":
    run_as_stage(main, "report")
    log_report(Path(sys.argv[-1]), read_yaml(PARAMS))
