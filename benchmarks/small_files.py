"""What the measurements of scaling make, in a module of its own: the store must find its code."""

import time
from pathlib import Path
from typing import Any

import numpy as np

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.part import UNSPECIFIED, Mesh, Part, load_mesh, save_part
from industnerf.artifacts.scores import Score, save_scores
from industnerf.artifacts.truth import Floor, Truth
from industnerf.artifacts.views import RgbdImage, Views, save_views
from industnerf.geometry.cameras import Cameras, look_at, pinhole
from industnerf.geometry.sphere import fibonacci_sphere

SIDE_PX, POINTS, FAMILIES = 8, 64, 20
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
FACES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]], np.int32)
own_seconds = [0.0, 0.0]  # of the wall and of the processor, that making results itself took


def fill(files: int, target: Path) -> None:
    """So many small files, all different."""
    for i in range(files):
        (target / f"{i:03}").write_text(f"{target.name} {i}")


class OwnTime:
    """Counts what is done within it as making results."""

    def __enter__(self) -> None:
        self.start = time.perf_counter(), time.process_time()

    def __exit__(self, *_: object) -> None:
        own_seconds[0] += time.perf_counter() - self.start[0]
        own_seconds[1] += time.process_time() - self.start[1]


def make_box(index: int, target: Path) -> None:
    """The part `index`: half a box, each of another size."""
    with OwnTime():
        size = 10.0 + index / 100
        mesh = Mesh.with_one_appearance(size * CORNERS, FACES)
        texts = (f"family-{index % FAMILIES}", "box", "file", "box.stl")
        part = Part(
            f"box-{index:05}",
            *texts,
            extents_mm=(size, size, size),
            area_mm2=3 * size**2,
            volume_mm3=None,
            bodies=1,
            faces=len(FACES),
            euler_number=2,
            visible_share=1.0,
            hull_hidden_share=0.0,
            strata=("thin",) if index % 3 else (),
            finishes=(UNSPECIFIED,),
            defects=(),
        )
        save_part(target, part, mesh)


def photograph(part: Path, target: Path, settings: Any, seed: int) -> None:
    """Gray photographs of 8x8 px: as many as `settings` say."""
    with OwnTime():
        count = settings.count + settings.held_out
        centers = 300 * fibonacci_sphere(count)
        K = np.tile(pinhole(35.0, SIDE_PX), (count, 1, 1))
        cameras = Cameras(K, look_at(centers, np.zeros(3)), SIDE_PX, SIDE_PX)
        gray = np.full((SIDE_PX, SIDE_PX), _draws(part).integers(256), np.uint8)
        image = RgbdImage(np.stack([gray] * 3, -1), gray > 0, gray.astype(np.float32))
        held_out = np.arange(count) >= settings.count
        views = Views(
            target, part.name, cameras, held_out, np.ones((count, 3)), 0.01, train_visible_share=1.0
        )
        save_views(views, [image] * count)


def sample_truth(part: Path, target: Path, *, settings: Any, seed: int) -> None:
    """A few points, and floors that nobody has measured."""
    with OwnTime():
        names = ("emd P1-even", "emd P1-iid", "emd P1-full")
        floors = {name: Floor(0.01, 0.0001) for name in names}
        Truth(_points(part), np.ones(POINTS, bool), floors).save(target)


def guess_cloud(method: Any, part: Path, views: Path, state: Any, target: Path, **_: Any) -> None:
    """A few points, with no regard to the photographs."""
    with OwnTime():
        gray, certain = np.full((POINTS, 3), 128, np.uint8), np.ones(POINTS, np.float32)
        view = np.full(POINTS, -1, np.int16)
        Cloud(part.name, _points(part), gray, certain, view, 0, 0).save(target)


def draw_scores(part: Path, truth: Path, views: Path, cloud: Path, target: Path, **_: Any) -> None:
    """Scores that nobody has measured."""
    with OwnTime():
        draws, diagonal = _draws(cloud / cloud.parent.name), "diagonal"
        scores = [
            Score("emd", protocol, draws.uniform(0.02, 0.2), 0.01, diagonal, "ok", 0.0001)
            for protocol in ("P1-even", "P1-iid", "P1-full")
        ]
        for name in ("within_0.5mm", "fscore_0.01"):
            scores.append(Score(name, "P1-dense", draws.uniform(0, 1), 1.0, "share", "ok", 0.0))
        save_scores(target, scores)


def _draws(path: Path) -> np.random.Generator:
    return np.random.default_rng([*f"{path.parent.name}/{path.name}".encode()])


def _points(part: Path) -> np.ndarray:
    size = load_mesh(part).vertices.max()
    return (size * _draws(part).random((POINTS, 3))).astype(np.float32)
