"""A small set of photographs and its transforms.json, for tests to spoil."""

import json
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from industnerf.artifacts.views import OPENGL
from industnerf.geometry.cameras import Cameras, look_at
from industnerf.geometry.sphere import fibonacci_sphere

WIDTH, HEIGHT, COUNT = 48, 32, 5
CENTER = np.array([10.0, -4.0, 3.0])  # what the cameras look at
FOCAL = 60.0


def cameras(count: int = COUNT, distance: float = 7.0) -> Cameras:
    """All round `CENTER`; neither square nor with the principal point in the middle."""
    K = np.array([[FOCAL, 0, 25.0], [0, FOCAL + 2, 15.0], [0, 0, 1]])
    eyes = CENTER + distance * fibonacci_sphere(count)
    return Cameras(np.tile(K, (count, 1, 1)), look_at(eyes, CENTER), WIDTH, HEIGHT)


def images(count: int = COUNT) -> np.ndarray:
    """(count, HEIGHT, WIDTH, 3) of noise."""
    return np.random.default_rng(7).integers(0, 256, (count, HEIGHT, WIDTH, 3), np.uint8)


def transforms_content(captured: Cameras) -> dict[str, Any]:
    """transforms.json as most tools write it."""
    (fx, _, cx), (_, fy, cy), _ = captured.K[0].tolist()
    return {
        "fl_x": fx,
        "fl_y": fy,
        "cx": cx,
        "cy": cy,
        "w": captured.width,
        "h": captured.height,
        "aabb_scale": 4,
        "frames": [
            {"file_path": f"rgb/{i:03d}.png", "transform_matrix": (c2w @ OPENGL).tolist()}
            for i, c2w in enumerate(captured.c2w)
        ],
    }


def write_image_set(folder: Path, **changes: Any) -> Path:
    """Photographs and transforms.json in `folder`, with `changes` to its shared keys."""
    (folder / "rgb").mkdir(parents=True)
    for i, pixels in enumerate(images()):
        Image.fromarray(pixels).save(folder / f"rgb/{i:03d}.png")
    return write_json_file(folder / "transforms.json", transforms_content(cameras()) | changes)


def write_json_file(path: Path, data: Any) -> Path:
    path.write_text(json.dumps(data))
    return path
