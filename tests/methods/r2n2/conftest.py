"""A net of the least width, its settings, and parts to learn from without files."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from industnerf.methods.base import Example
from industnerf.schema import AugmentSettings, R2n2Settings, TrainingSettings

NO_AUGMENTATION = AugmentSettings(roll_deg=0.0, zoom=0.0, color_jitter=0.0, noise=0.0)


@pytest.fixture
def settings() -> R2n2Settings:
    """Pictures of 16 px, and six steps."""
    training = TrainingSettings(
        max_steps=6,
        batch_size=2,
        lr=1e-3,
        weight_decay=0.0,
        val_fraction=0.3,
        val_interval=2,
        patience=9,
        keep="best",
    )
    return R2n2Settings(
        size="tiny",
        image_px=16,
        channel_divisor=32,
        max_views=3,
        points=500,
        pretraining=training,
        training=training,
        augment=replace(NO_AUGMENTATION, color_jitter=0.1),
    )


class Box(Example):
    """A bar along x, without files; it is as thick, and its pictures as bright, as its id says."""

    @property
    def size(self) -> float:
        """Between 0 and 1."""
        return float(self.part_id)

    @property
    def mesh(self) -> tuple[np.ndarray, np.ndarray]:
        """Of edges 1, `size`, `size`."""
        bar = trimesh.creation.box((1.0, self.size, self.size))
        return np.asarray(bar.vertices), np.asarray(bar.faces, np.int32)

    def rgb(self, px: int, count: int) -> np.ndarray:
        """View i is brighter by i; of four views."""
        level = round(200 * self.size) + np.arange(min(count, 4), dtype=np.uint8)
        return np.broadcast_to(level[:, None, None, None], (len(level), px, px, 3)).astype(np.uint8)

    def background(self, count: int) -> np.ndarray:
        """White."""
        return np.ones((min(count, 4), 3))

    def picture_frames(self, count: int) -> np.ndarray:
        """Those of the part."""
        return np.tile(np.eye(3), (min(count, 4), 1, 1))


@pytest.fixture
def boxes() -> list[Box]:
    """Three of them."""
    nowhere = Path("no such file")
    return [Box(name, name, nowhere, nowhere, frozenset()) for name in ("0.25", "0.5", "0.75")]
