"""Every protocol that the paper's EMD may mean, over a finished study: results/grid.

python -m pipeline.grid        resumable; what is done is in the store
"""

from functools import partial
from pathlib import Path
from typing import Any

from industnerf.artifacts.cloud import cloud_files
from industnerf.artifacts.files import read_json, write_json, write_text
from industnerf.artifacts.part import load_parts
from industnerf.artifacts.split import load_split
from industnerf.cli import run_command
from industnerf.config import load_params
from industnerf.errors import BadArtifact
from industnerf.metrics.protocol_grid import SCHEMA, measure_grid
from industnerf.report.part_subsets import seed_parts
from industnerf.report.publish.provenance import build_provenance
from industnerf.report.tables.protocol_grid import grid_csv, grid_md, grid_rows
from industnerf.schema import Params
from industnerf.stage import Task, read_index, run_stage
from pipeline.publish import check_finished, require_embedded_parts

METHODS = ("industnerf", "hull")
DATA, OUT, RESULTS = Path("data"), Path("runs/grid"), Path("results/grid")


def main() -> None:
    # First: without a commit, or with clouds of another one, the work would be in vain.
    provenance = build_provenance("python -m pipeline.grid")
    # The report shows the grid, and is out of date after it.
    check_finished(Path(), "make repro", allowed_stale="report")
    params, assignments = load_params(), load_split(DATA / "split.json")
    require_embedded_parts(params)  # results/grid is of the study's
    test_parts = sorted(
        part for part in _reconstructed_parts() if assignments[part].split == "test"
    )
    seed_subset = seed_parts(test_parts)  # those are measured with many points too
    tasks = [_grid_task(part, part in seed_subset, params) for part in test_parts]
    run_stage("grid", tasks, OUT, "report")
    rows = grid_rows(
        {part: _read_cells(OUT / part / "grid.json") for part in read_index(OUT)},
        {part.part_id: part.diagonal_mm for part in load_parts(DATA / "parts")},
    )
    RESULTS.mkdir(parents=True, exist_ok=True)
    write_text(RESULTS / "grid.csv", grid_csv(rows))
    write_text(RESULTS / "grid.md", grid_md(rows))
    write_json(RESULTS / "made.json", provenance)
    print(f"{RESULTS / 'grid.md'}, {RESULTS / 'grid.csv'}")


def _read_cells(path: Path) -> dict[str, Any]:
    """Raises BadArtifact if the file is torn: then so is the store's, from where it was taken."""
    try:
        return read_json(path, SCHEMA, "grid")["cells"]
    except BadArtifact:
        message = f"{path} cannot be read; `python -m industnerf.doctor` says how it is mended"
        raise BadArtifact(message) from None


def _reconstructed_parts() -> set[str]:
    """The parts of which every subject made a cloud."""
    folders = [DATA / "clouds" / name for name in METHODS]
    if missing := [folder.name for folder in folders if not (folder / "index.json").exists()]:
        raise BadArtifact(f"{DATA} holds no cloud of {', '.join(missing)}: `make repro`")
    return set.intersection(*(set(read_index(folder)) for folder in folders))


def _grid_task(part: str, include_large: bool, params: Params) -> Task:
    clouds = {name: DATA / "clouds" / name / part for name in METHODS}
    settings = {"settings": params.evaluate, "seed": params.seed, "include_large": include_large}
    make = partial(measure_grid, DATA / "parts" / part, DATA / "truth" / part, clouds, **settings)
    files = [file for folder in clouds.values() for file in cloud_files(folder)]
    inputs = (DATA / "parts" / part / "mesh.npz", DATA / "truth" / part, *files)
    return Task(part, make, [params.evaluate, params.seed, include_large], inputs)


if __name__ == "__main__":
    run_command(main)
