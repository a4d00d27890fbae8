"""The photographs of one part, and the cameras that took them.

    <part>/cameras.json      our convention: OpenCV axes, mm, px
    <part>/transforms.json   the NeRF convention: OpenGL axes
    <part>/rgb|mask|depth/000.png ...   training views first, then the held-out ones

Depth is z in mm, stored as a multiple of `depth_scale_mm` in 16 bits; 0 is background.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Float32, UInt8
from PIL import Image

from industnerf.artifacts.files import read_json, write_json
from industnerf.errors import BadArtifact
from industnerf.geometry.cameras import Cameras

SCHEMA = 1
OPENGL = np.diag([1.0, -1.0, -1.0, 1.0])  # NeRF tools: +y up, camera looks along -z


@dataclass(frozen=True)
class Frame:
    """One photograph."""

    rgb: UInt8[np.ndarray, "h w 3"]
    mask: Bool[np.ndarray, "h w"]
    depth_mm: Float32[np.ndarray, "h w"]  # z in the camera frame; 0 is background


@dataclass(frozen=True)
class Views:
    """The photographs in `folder`; images are read when asked for."""

    folder: Path
    part_id: str
    cameras: Cameras
    held_out: Bool[np.ndarray, "n"]
    background: Float[np.ndarray, "3"]  # in [0, 1]
    depth_scale_mm: float

    @property
    def train(self) -> np.ndarray:
        """Indices of the training views."""
        return np.flatnonzero(~self.held_out)

    def rgb(self, which: np.ndarray) -> UInt8[np.ndarray, "n h w 3"]:
        """Colour images of the views `which`."""
        return self._read("rgb", which)

    def mask(self, which: np.ndarray) -> Bool[np.ndarray, "n h w"]:
        """True where a pixel's centre shows the part."""
        return self._read("mask", which) > 0

    def depth_mm(self, which: np.ndarray) -> Float32[np.ndarray, "n h w"]:
        """z in the camera frame, 0 where a pixel's centre shows the background."""
        return self._read("depth", which).astype(np.float32) * np.float32(self.depth_scale_mm)

    def _read(self, kind: str, which: np.ndarray) -> np.ndarray:
        images = []
        for index in which:
            path = self.folder / kind / f"{index:03d}.png"
            try:
                with Image.open(path) as image:
                    images.append(np.asarray(image))
            except (OSError, SyntaxError, ValueError) as error:  # pillow raises all three
                raise BadArtifact(
                    f"{path}: {error}; `dvc repro -f views` writes it anew."
                ) from None
            if images[-1].shape[:2] != (self.cameras.height, self.cameras.width):
                raise BadArtifact(f"{path} is {images[-1].shape[:2]}, its camera says otherwise")
        return np.stack(images)


def load_views(folder: Path) -> Views:
    """Read `cameras.json`; raises BadArtifact if it is missing, torn or of another schema."""
    content = read_json(folder / "cameras.json", SCHEMA, "views")
    cameras = content["cameras"]
    return Views(
        folder,
        content["part_id"],
        Cameras(
            np.array([camera["K"] for camera in cameras], float),
            np.array([camera["c2w"] for camera in cameras], float),
            content["width"],
            content["height"],
        ),
        np.array([camera["held_out"] for camera in cameras], bool),
        np.array(content["background"], float),
        content["depth_scale_mm"],
    )


def save_views(views: Views, frames: Iterable[Frame]) -> None:
    """Write the cameras, and every frame as soon as it comes, into `views.folder`."""
    for kind in ("rgb", "mask", "depth"):
        (views.folder / kind).mkdir(parents=True)
    write_json(views.folder / "cameras.json", _ours(views))
    write_json(views.folder / "transforms.json", _nerf(views))
    for index, frame in enumerate(frames):
        depth = np.rint(frame.depth_mm / views.depth_scale_mm).astype(np.uint16)
        _write_png(views.folder / f"rgb/{index:03d}.png", frame.rgb)
        _write_png(views.folder / f"mask/{index:03d}.png", frame.mask)
        _write_png(views.folder / f"depth/{index:03d}.png", depth)


def _write_png(path: Path, pixels: np.ndarray) -> None:
    # Of a part's views, level 2 writes a megabyte more than 6, in half the time or less.
    Image.fromarray(pixels).save(path, compress_level=2)


def _ours(views: Views) -> dict:
    cameras = zip(views.cameras.K, views.cameras.c2w, views.held_out, strict=True)
    return {
        "schema": SCHEMA,
        "part_id": views.part_id,
        "convention": "OpenCV axes (+x right, +y down, +z forward), mm; pixel (0, 0) is the "
        "top-left corner; depth = value * depth_scale_mm along z, 0 = background",
        "width": views.cameras.width,
        "height": views.cameras.height,
        "background": views.background.tolist(),
        "depth_scale_mm": views.depth_scale_mm,
        "cameras": [
            {"held_out": bool(held_out), "K": K.tolist(), "c2w": c2w.tolist()}
            for K, c2w, held_out in cameras
        ],
    }


def _nerf(views: Views) -> dict:
    K, names = views.cameras.K[0], [f"rgb/{i:03d}.png" for i in range(len(views.cameras))]
    frames = [
        {
            "file_path": name,
            "mask_path": name.replace("rgb", "mask"),
            "depth_file_path": name.replace("rgb", "depth"),
            "transform_matrix": (c2w @ OPENGL).tolist(),
        }
        for name, c2w in zip(names, views.cameras.c2w, strict=True)
    ]
    return {
        "camera_model": "OPENCV",
        "camera_angle_x": float(2 * np.arctan(views.cameras.width / 2 / K[0, 0])),
        "fl_x": float(K[0, 0]),
        "fl_y": float(K[1, 1]),
        "cx": float(K[0, 2]),
        "cy": float(K[1, 2]),
        "w": views.cameras.width,
        "h": views.cameras.height,
        "depth_unit_scale_factor": views.depth_scale_mm,
        "train_filenames": [names[i] for i in views.train],
        "test_filenames": [names[i] for i in np.flatnonzero(views.held_out)],
        "frames": frames,
    }
