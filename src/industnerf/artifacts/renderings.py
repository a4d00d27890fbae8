"""A method's renderings from the held-out cameras: the archive `renderings.zip` beside its cloud.

    renderings.json
    rgb|depth|opacity/000.png ...   in the order of the held-out cameras

Depth is z in mm, stored as a multiple of `depth_scale_mm` in 16 bits; 0 is background.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float32, UInt8

from industnerf.artifacts.archive import read_members, write_archive
from industnerf.artifacts.files import corrupt_error, json_text, parse_json
from industnerf.artifacts.png import MAX_DEPTH_VALUE, decode_png, encode_png, quantize_depth

SCHEMA = 1
ARCHIVE, INDEX = "renderings.zip", "renderings.json"
FOREGROUND_THRESHOLD = 128  # the first of 256 levels that is at least half opaque
# pixels, and what comes after rows and columns
KINDS = {"rgb": (np.uint8, (3,)), "depth": (np.uint16, ()), "opacity": (np.uint8, ())}


@dataclass(frozen=True)
class Renderings:
    """One part from `n` cameras."""

    rgb: UInt8[np.ndarray, "n h w 3"]  # linear, as the photographs are
    depth_mm: Float32[np.ndarray, "n h w"]  # z in the camera frame; 0 is background
    opacity: UInt8[np.ndarray, "n h w"]  # 255 is opaque

    def __len__(self) -> int:
        return len(self.rgb)

    @property
    def foreground(self) -> Bool[np.ndarray, "n h w"]:
        """Where the opacity is at least one half."""
        return self.opacity >= FOREGROUND_THRESHOLD

    def save(self, cloud: Path) -> None:
        """Write the archive into the folder `cloud`; depth must be finite and >= 0."""
        count, height, width = self.opacity.shape
        scale = float(self.depth_mm.max(initial=0.0) or 1.0) / MAX_DEPTH_VALUE
        sizes = {"count": count, "height": height, "width": width}
        depth = quantize_depth(self.depth_mm, scale)
        record = {"schema": SCHEMA, **sizes, "depth_scale_mm": scale}
        with write_archive(cloud / ARCHIVE) as add:
            add(INDEX, json_text(record).encode())
            for kind, pixels in (("rgb", self.rgb), ("depth", depth), ("opacity", self.opacity)):
                for index, image in enumerate(pixels):
                    add(f"{kind}/{index:03d}.png", encode_png(image))

    @staticmethod
    def load(cloud: Path) -> "Renderings | None":
        """Read what `save` wrote, None if the method does not render.

        Raises BadArtifact if a file is missing or torn.
        """
        if not (cloud / ARCHIVE).exists():
            return None
        metadata = _read_index(cloud)
        colors, depth, opacity = (
            _read_images(cloud, kind, range(metadata["count"]), metadata) for kind in KINDS
        )
        depth_mm = depth.astype(np.float32) * np.float32(metadata["depth_scale_mm"])
        return Renderings(colors, depth_mm, opacity)

    @staticmethod
    def load_first_rgb(cloud: Path) -> UInt8[np.ndarray, "h w 3"] | None:
        """The colors from the first held-out camera alone; None and errors as of `load`."""
        if not (cloud / ARCHIVE).exists() or not (metadata := _read_index(cloud))["count"]:
            return None
        return _read_images(cloud, "rgb", range(1), metadata)[0]


def _read_index(cloud: Path) -> dict:
    (data,) = read_members(cloud / ARCHIVE, [INDEX], "reconstruct")
    return parse_json(data, cloud / ARCHIVE / INDEX, SCHEMA, "reconstruct")


def _read_images(cloud: Path, kind: str, indices: range, metadata: dict) -> np.ndarray:
    dtype, channels = KINDS[kind]
    height, width = metadata["height"], metadata["width"]
    names = [f"{kind}/{index:03d}.png" for index in indices]
    pngs = read_members(cloud / ARCHIVE, names, "reconstruct")
    images = np.empty((len(names), height, width, *channels), dtype)
    for index, (name, png) in enumerate(zip(names, pngs, strict=True)):
        path = cloud / ARCHIVE / name
        pixels = decode_png(png, path, height, width, "reconstruct")
        if (pixels.dtype, pixels.shape[2:]) != KINDS[kind]:
            what = f"holds {pixels.dtype} in {pixels.shape[2:] or 1} channels"
            raise corrupt_error(path, what, "reconstruct")
        images[index] = pixels
    return images
