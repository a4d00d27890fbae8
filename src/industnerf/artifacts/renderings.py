"""A method's renderings from the held-out cameras, beside its cloud.

    <cloud>/renderings/renderings.json
    <cloud>/renderings/rgb|depth|opacity/000.png ...   in the order of the held-out cameras

Depth is z in mm, stored as a multiple of `depth_scale_mm` in 16 bits; 0 is background.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float32, UInt8

from industnerf.artifacts.files import corrupt_error, read_json, write_json
from industnerf.artifacts.png import MAX_DEPTH_VALUE, quantize_depth, read_png, write_png

SCHEMA = 1
FOLDER, INDEX = "renderings", "renderings.json"
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
        """Write the folder `renderings` into the folder `cloud`; depth must be finite and >= 0."""
        folder, (count, height, width) = cloud / FOLDER, self.opacity.shape
        scale = float(self.depth_mm.max(initial=0.0) or 1.0) / MAX_DEPTH_VALUE
        sizes = {"count": count, "height": height, "width": width}
        depth = quantize_depth(self.depth_mm, scale)
        for kind, pixels in (("rgb", self.rgb), ("depth", depth), ("opacity", self.opacity)):
            (folder / kind).mkdir(parents=True)
            for index, image in enumerate(pixels):
                write_png(folder / kind / f"{index:03d}.png", image)
        write_json(folder / INDEX, {"schema": SCHEMA, **sizes, "depth_scale_mm": scale})

    @staticmethod
    def load(cloud: Path) -> "Renderings | None":
        """Read what `save` wrote, None if the method does not render.

        Raises BadArtifact if a file is missing or torn.
        """
        folder = cloud / FOLDER
        if not folder.is_dir():
            return None
        metadata = read_json(folder / INDEX, SCHEMA, "reconstruct")
        colors, depth, opacity = (_read_images(folder / kind, metadata) for kind in KINDS)
        depth_mm = depth.astype(np.float32) * np.float32(metadata["depth_scale_mm"])
        return Renderings(colors, depth_mm, opacity)


def _read_images(folder: Path, metadata: dict) -> np.ndarray:
    kind, channels = KINDS[folder.name]
    height, width = metadata["height"], metadata["width"]
    images = np.empty((metadata["count"], height, width, *channels), kind)
    for index in range(len(images)):
        path = folder / f"{index:03d}.png"
        pixels = read_png(path, height, width, "reconstruct")
        if (pixels.dtype, pixels.shape[2:]) != KINDS[folder.name]:
            what = f"holds {pixels.dtype} in {pixels.shape[2:] or 1} channels"
            raise corrupt_error(path, what, "reconstruct")
        images[index] = pixels
    return images
