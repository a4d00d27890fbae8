"""The photographs of one part, and the cameras that took them: the archive `photographs.zip`.

    cameras.json      our convention: OpenCV axes, mm, px
    transforms.json   the NeRF convention: OpenGL axes
    rgb|mask|depth/000.png ...   training views first, then the held-out ones
    true_cameras.json only where the training cameras above are wrong on purpose

Depth is z in mm, stored as a multiple of `depth_scale_mm` in 16 bits; 0 is background.

With `views.calibration` the photographs are those of the true cameras, while cameras.json and
transforms.json hold what a faulty calibration records of the training views; held-out cameras
are always exact.  The true cameras stand in a file of their own, which no method is given.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Float32, UInt8

from industnerf.artifacts.archive import read_members, write_archive
from industnerf.artifacts.files import json_text, parse_json
from industnerf.artifacts.png import decode_png, encode_png, quantize_depth
from industnerf.geometry.cameras import Cameras

SCHEMA = 3
ARCHIVE, CAMERAS, TRUE_CAMERAS = "photographs.zip", "cameras.json", "true_cameras.json"
OPENGL = np.diag([1.0, -1.0, -1.0, 1.0])  # NeRF tools: +y up, camera looks along -z


@dataclass(frozen=True)
class RgbdImage:
    """One photograph."""

    rgb: UInt8[np.ndarray, "h w 3"]
    mask: Bool[np.ndarray, "h w"]
    depth_mm: Float32[np.ndarray, "h w"]  # z in the camera frame; 0 is background


@dataclass(frozen=True)
class Views:
    """The photographs in `folder`; images are read on demand."""

    folder: Path
    part_id: str
    cameras: Cameras
    held_out: Bool[np.ndarray, "n"]
    background: Float[np.ndarray, "n 3"]  # in [0, 1]
    depth_scale_mm: float
    train_visible_share: float  # share of the part's area that a training view shows

    @property
    def train_indices(self) -> np.ndarray:
        """Indices of the training views."""
        return np.flatnonzero(~self.held_out)

    def rgb(self, indices: np.ndarray) -> UInt8[np.ndarray, "n h w 3"]:
        """Color images of the views `indices`."""
        return self._read("rgb", indices)

    def mask(self, indices: np.ndarray) -> Bool[np.ndarray, "n h w"]:
        """True where a pixel's center shows the part."""
        return self._read("mask", indices) > 0

    def depth_mm(self, indices: np.ndarray) -> Float32[np.ndarray, "n h w"]:
        """z in the camera frame, 0 where a pixel's center shows the background."""
        return self._read("depth", indices).astype(np.float32) * np.float32(self.depth_scale_mm)

    def _read(self, kind: str, indices: np.ndarray) -> np.ndarray:
        archive, size = self.folder / ARCHIVE, (self.cameras.height, self.cameras.width)
        names = [f"{kind}/{index:03d}.png" for index in indices]
        pngs = zip(read_members(archive, names, "views"), names, strict=True)
        return np.stack([decode_png(png, archive / name, *size, "views") for png, name in pngs])


def load_views(folder: Path) -> Views:
    """Read `cameras.json`; raises BadArtifact if it is missing, torn or of another schema."""
    content = _read_cameras(folder, CAMERAS)
    rows = content["cameras"]
    return Views(
        folder,
        content["part_id"],
        _cameras(content, rows),
        np.array([row["held_out"] for row in rows], bool),
        np.array([row["background"] for row in rows], float),
        content["depth_scale_mm"],
        content["train_visible_share"],
    )


def load_true_cameras(folder: Path) -> Cameras:
    """The cameras that took the photographs, which differ from `Views.cameras` if these are wrong.

    For evaluation, never for a method.  Raises BadArtifact as `load_views` does.
    """
    if _read_cameras(folder, CAMERAS)["exact"]:
        return load_views(folder).cameras
    content = _read_cameras(folder, TRUE_CAMERAS)
    return _cameras(content, content["cameras"])


def _read_cameras(folder: Path, name: str) -> dict:
    (data,) = read_members(folder / ARCHIVE, [name], "views")
    return parse_json(data, folder / ARCHIVE / name, SCHEMA, "views")


def _cameras(content: dict, rows: list[dict]) -> Cameras:
    return Cameras(
        np.array([row["K"] for row in rows], float),
        np.array([row["c2w"] for row in rows], float),
        content["width"],
        content["height"],
    )


def save_views(
    views: Views, images: Iterable[RgbdImage], true_cameras: Cameras | None = None
) -> None:
    """Write the cameras, and every image as soon as it comes, into the archive in `views.folder`.

    `true_cameras` took the images, where `views.cameras` are wrong.
    """
    records = {
        CAMERAS: _cameras_json(views, exact=true_cameras is None),
        "transforms.json": _transforms_json(views),
    }
    if true_cameras is not None:
        records[TRUE_CAMERAS] = _true_cameras_json(true_cameras)
    with write_archive(views.folder / ARCHIVE) as add:
        for name, record in records.items():
            add(name, json_text(record).encode())
        for index, image in enumerate(images):
            depth = quantize_depth(image.depth_mm, views.depth_scale_mm)
            for kind, pixels in (("rgb", image.rgb), ("mask", image.mask), ("depth", depth)):
                add(f"{kind}/{index:03d}.png", encode_png(pixels))


def _cameras_json(views: Views, *, exact: bool) -> dict:
    rows = zip(_camera_rows(views.cameras), views.held_out, views.background, strict=True)
    return {
        "schema": SCHEMA,
        "part_id": views.part_id,
        "convention": "OpenCV axes (+x right, +y down, +z forward), mm; pixel (0, 0) is the "
        "top-left corner; depth = value * depth_scale_mm along z, 0 = background",
        "exact": exact,  # false: the training cameras are wrong by views.calibration
        "width": views.cameras.width,
        "height": views.cameras.height,
        "depth_scale_mm": views.depth_scale_mm,
        "train_visible_share": views.train_visible_share,
        "cameras": [
            {"held_out": bool(held_out), "background": color.tolist()} | row
            for row, held_out, color in rows
        ],
    }


def _true_cameras_json(cameras: Cameras) -> dict:
    size = {"width": cameras.width, "height": cameras.height}
    return {"schema": SCHEMA} | size | {"cameras": _camera_rows(cameras)}


def _camera_rows(cameras: Cameras) -> list[dict]:
    return [
        {"K": K.tolist(), "c2w": c2w.tolist()}
        for K, c2w in zip(cameras.K, cameras.c2w, strict=True)
    ]


def _transforms_json(views: Views) -> dict:
    """One lens for all frames where they share it, else one for each: NeRF tools read both.

    So it is with the `background`, a key of our own.
    """
    cameras, names = views.cameras, [f"rgb/{i:03d}.png" for i in range(len(views.cameras))]
    intrinsics = [_intrinsics(K, cameras.width) for K in cameras.K]
    shared = all(own_intrinsics == intrinsics[0] for own_intrinsics in intrinsics)
    colors = [{"background": color.tolist()} for color in views.background]
    same_color = all(color == colors[0] for color in colors)
    frames = [
        {
            "file_path": name,
            "mask_path": name.replace("rgb", "mask"),
            "depth_file_path": name.replace("rgb", "depth"),
            "transform_matrix": (c2w @ OPENGL).tolist(),
        }
        | ({} if shared else own_intrinsics)
        | ({} if same_color else color)
        for name, c2w, own_intrinsics, color in zip(
            names, cameras.c2w, intrinsics, colors, strict=True
        )
    ]
    return {
        "camera_model": "OPENCV",
        **(intrinsics[0] if shared else {}),
        **(colors[0] if same_color else {}),
        "w": cameras.width,
        "h": cameras.height,
        "depth_unit_scale_factor": views.depth_scale_mm,
        "train_filenames": [names[i] for i in views.train_indices],
        "test_filenames": [names[i] for i in np.flatnonzero(views.held_out)],
        "frames": frames,
    }


def _intrinsics(K: Float[np.ndarray, "3 3"], width: int) -> dict[str, float]:
    return {
        "camera_angle_x": float(2 * np.arctan(width / 2 / K[0, 0])),
        "fl_x": float(K[0, 0]),
        "fl_y": float(K[1, 1]),
        "cx": float(K[0, 2]),
        "cy": float(K[1, 2]),
    }
