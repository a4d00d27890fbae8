"""What the tests of photographs share: the shipped settings, and parts on disk."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import Mesh, save_part
from industnerf.config import load_params
from industnerf.schema import ViewsParams
from tests.samples import unit_part


@pytest.fixture
def shipped(root: Path) -> ViewsParams:
    """The section `views` of params.yaml."""
    return load_params(root / "params.yaml").views


@pytest.fixture
def settings(shipped: ViewsParams) -> ViewsParams:
    """As shipped, but few and small pictures."""
    return replace(shipped, count=4, held_out=2, resolution=64)


@pytest.fixture
def as_mesh() -> Callable[[trimesh.Trimesh], Mesh]:
    """Turns trimesh's solids into ours."""
    return lambda solid: Mesh.with_one_appearance(
        np.array(solid.vertices, float), np.array(solid.faces, np.int32)
    )


@pytest.fixture
def as_part(tmp_path: Path) -> Callable[[Mesh], Path]:
    """Writes a mesh as a part and gives its folder."""

    def write(mesh: Mesh) -> Path:
        extents = tuple(np.ptp(mesh.vertices, axis=0).tolist())
        (tmp_path / "block").mkdir()
        save_part(tmp_path / "block", unit_part("block", extents_mm=extents), mesh)
        return tmp_path / "block"

    return write
