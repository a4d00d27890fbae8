"""Do the abstract procedural solids give away the families of the study?

OMP_NUM_THREADS=1 python benchmarks/leakage.py DATA
OMP_NUM_THREADS=1 python benchmarks/leakage.py DATA --by-kind

DATA is the folder `data` of a finished run, of which `parts`, `views` and `procedural` are read;
the latter has solids of abstract kinds.  Of each part the nearest shape is looked for in several
sets, as `retrieval_procedural` does it, and scored against the part: EMD of 1024 even points in
diagonals, the nearest shape scaled to the part's longest edge.

What a network may learn from is what shares no family with the part, so chance is the nearest of
all parts of other families.  Solids give nothing away where as many of them are no nearer.  The
mean is over DRAWS random sets of that many.  Solids of the kinds that resemble families, and
parts of all families, show what the check finds where something is given away.  The nearest box
shows what is found without any picture, larger sets what comes with number.

`--by-kind` asks of each kind alone, which a mixture of all kinds hides: for each family the nearest
of KIND_SOLIDS solids of one kind, and of as many parts of other families.  Nearest by the Chamfer
distance of surfaces in the unit cube: retrieval could not choose better.
"""

import argparse
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from statistics import fmean
from tempfile import TemporaryDirectory

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from industnerf.artifacts.part import Mesh, load_mesh, load_parts
from industnerf.config import load_params
from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.learning.procedural_shapes import ProceduralShape, load_procedural_shapes
from industnerf.learning.targets import surface_points
from industnerf.learning.training_shape import TrainingShape
from industnerf.methods import load_method
from industnerf.methods.base import Example
from industnerf.methods.retrieval import even_points, feature_distances, hog_features
from industnerf.metrics.emd import emd
from industnerf.parts.procedural import (
    ALL_KINDS,
    DEFAULT_KINDS,
    RESEMBLING_KINDS,
    ProceduralSolid,
    procedural_solid,
)
from industnerf.procedural_dataset import chunk_ranges, make_chunk
from industnerf.report.statistics.significance import paired_change
from industnerf.report.tables.formats import format_interval, markdown_table
from industnerf.seeds import generator
from industnerf.stage import read_index

VIEWS, IMAGE_PX, POINTS = 8, 64, 1024
DRAWS = 4
RESEMBLING_SEED, RESEMBLING_DRAWN = 1, 1000  # of which 16 kinds in 57 resemble a family
CHANCE = "parts of other families"
KIND_SOLIDS, KIND_POINTS = 60, 512

Cloud = tuple[Float[np.ndarray, "n 3"], cKDTree]


class Shapes:
    """What is compared of shapes: features of their pictures, proportions, surfaces."""

    def __init__(self, shapes: Sequence[TrainingShape]) -> None:
        rng = generator(0, "leakage")
        surface = cache(lambda row: even_points(shapes[row].surface_pool(rng), POINTS))
        extents = np.array([np.ptp(shape.surface_pool(rng), axis=0) for shape in shapes], float)
        self.features = np.stack([hog_features(one.rgb(IMAGE_PX, VIEWS)) for one in shapes])
        self.extents = extents / extents.max(axis=1, keepdims=True)
        self.surface = lambda row: surface(row).astype(np.float64)

    def nearest(self, rows: Int[np.ndarray, "n"], query: Float[np.ndarray, "..."]) -> int:
        """That of `rows` which is most like `query`, features of pictures or a box."""
        if query.ndim == 1:
            return int(rows[np.abs(self.extents[rows] - query).sum(axis=1).argmin()])
        return int(rows[feature_distances(self.features[rows], query).argmin()])


def resembling_solids(folder: Path) -> list[ProceduralShape]:
    """Solids of the kinds that resemble families, made into `folder`."""
    params = load_params()
    settings = replace(params.procedural, kinds="all", views=VIEWS, image_px=IMAGE_PX)
    chunks = chunk_ranges(RESEMBLING_DRAWN)
    for name, indices in chunks.items():
        (folder / name).mkdir()
        make_chunk(
            folder / name,
            indices=indices,
            seed=RESEMBLING_SEED,
            settings=settings,
            views=params.views,
        )
    return [
        one for one in load_procedural_shapes(folder, list(chunks)) if one.kind in RESEMBLING_KINDS
    ]


def emds_by_set(
    parts: Shapes, families: Mapping[str, str], solids: Shapes, resembling: Shapes
) -> dict[str, dict[str, float]]:
    """EMD of the nearest shape of each set, by part."""
    rng, results = generator(0, "leakage sets"), defaultdict(dict)

    def score(part: int, shapes: Shapes, row: int) -> float:
        diagonal = float(np.linalg.norm(parts.extents[part]))
        return emd(shapes.surface(row), parts.surface(part)).value / diagonal

    def score_sets(part: int, shapes: Shapes, count: int, by: str = "features") -> float:
        total, query = len(shapes.features), getattr(parts, by)[part]
        draws = DRAWS if count < total else 1
        sets = [rng.choice(total, min(count, total), replace=False) for _ in range(draws)]
        return fmean(score(part, shapes, shapes.nearest(rows, query)) for rows in sets)

    for part, (part_id, family) in enumerate(families.items()):
        is_other = np.array([other != family for other in families.values()])
        count, query = int(is_other.sum()), parts.features[part]
        not_itself = np.flatnonzero(np.arange(len(families)) != part)
        values = {
            CHANCE: score(part, parts, parts.nearest(np.flatnonzero(is_other), query)),
            "as many abstract solids": score_sets(part, solids, count),
            "as many, by their boxes alone": score_sets(part, solids, count, "extents"),
            "as many that resemble families": score_sets(part, resembling, count),
            "parts of all families": score(part, parts, parts.nearest(not_itself, query)),
            "1000 abstract solids": score_sets(part, solids, 1000),
            "all abstract solids": score_sets(part, solids, len(solids.features)),
        }
        for name, value in values.items():
            results[name][part_id] = value
    return results


def nearest_by_kind(data: Path) -> None:
    """A row a family: chance, the kind that resembles it, the abstract kind that comes nearest."""
    rng = generator(0, "leakage kinds")

    def cloud(mesh: Mesh | ProceduralSolid) -> Cloud:
        unit = BoundingCube.of(mesh.vertices).to_unit(mesh.vertices)
        points = surface_points(unit, mesh.faces, KIND_POINTS, rng)
        return points, cKDTree(points)

    def nearest(one: Cloud, others: Sequence[Cloud]) -> float:
        return min(
            tree.query(one[0])[0].mean() + one[1].query(points)[0].mean() for points, tree in others
        )

    families, clouds = {}, {}
    for part in load_parts(data / "parts"):
        families[part.part_id] = part.family
        clouds[part.part_id] = cloud(load_mesh(data / "parts" / part.part_id))
    kinds = {
        kind: [cloud(procedural_solid(0, index, [kind])) for index in range(KIND_SOLIDS)]
        for kind in ALL_KINDS
    }
    rows = []
    for family in sorted(set(families.values())):
        members = [part for part in families if families[part] == family]
        others = [part for part in families if families[part] != family]
        chance = fmean(
            nearest(clouds[part], [clouds[i] for i in rng.choice(others, KIND_SOLIDS, False)])
            for part in members
        )
        by_kind = {
            kind: fmean(nearest(clouds[part], solids) for part in members)
            for kind, solids in kinds.items()
        }
        abstract = min(DEFAULT_KINDS, key=by_kind.__getitem__)
        nearer = sum(by_kind[kind] < chance for kind in DEFAULT_KINDS)
        own = [kind for kind, resembled in RESEMBLING_KINDS.items() if resembled == family]
        rows.append(
            [
                *(family, f"{chance:.4f}", f"`{own[0]}` {by_kind[own[0]]:.4f}"),
                *(f"`{abstract}` {by_kind[abstract]:.4f}", f"{nearer} of {len(DEFAULT_KINDS)}"),
            ]
        )
    head = ["family", "chance", "kind that resembles it", "nearest abstract kind", "nearer"]
    print(markdown_table(head, rows))


def nearest_by_set(data: Path) -> None:
    """A row a set of shapes, then all of them by family."""
    params = load_params()
    method = load_method("retrieval_procedural")
    known = [
        part for part in load_parts(data / "parts") if (data / "views" / part.part_id).is_dir()
    ]
    families = {part.part_id: part.family for part in known}
    examples = [
        Example(
            part.part_id,
            part.family,
            data / "parts" / part.part_id,
            data / "views" / part.part_id,
            method.inputs,
        )
        for part in known
    ]
    chunks = list(read_index(data / "procedural"))
    solids = load_procedural_shapes(data / "procedural", chunks)
    with TemporaryDirectory() as folder:
        resembling = resembling_solids(Path(folder))
        sets = [Shapes(examples), Shapes(solids), Shapes(resembling)]
        results = emds_by_set(sets[0], families, *sets[1:])
    print(f"{len(known)} parts, {len(solids)} abstract solids, {len(resembling)} that resemble")
    rows = []
    for name, values in results.items():
        change = paired_change(results[CHANCE], values, families, params.report, params.seed)
        interval = format_interval(change.low, change.high, "+.4f")
        rows.append(
            [
                name,
                f"{fmean(values.values()):.4f}",
                f"{change.mean:+.4f} ({interval})",
                f"{100 * change.num_lower / change.parts:.0f} %",
            ]
        )
    print(markdown_table(["nearest of", "EMD", "less chance", "nearer on"], rows))
    by_family = [
        [
            family,
            *(
                f"{fmean(values[p] for p in families if families[p] == family):.4f}"
                for values in results.values()
            ),
        ]
        for family in sorted(set(families.values()))
    ]
    print(markdown_table(["family", *results], by_family))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--by-kind", action="store_true")
    arguments = parser.parse_args()
    if arguments.by_kind:
        nearest_by_kind(arguments.data)
    else:
        nearest_by_set(arguments.data)


if __name__ == "__main__":
    main()
