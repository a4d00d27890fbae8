"""One small part and its photographs, shared by all tests of methods."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from industnerf.artifacts.part import Mesh, save_part
from industnerf.capture.render import render_part
from industnerf.config import load_params
from industnerf.schema import Params
from tests.samples import unit_part

OFFSET = np.array([300.0, -150.0, 90.0])  # mm: far enough off to tell any other frame apart
SIZE = np.array([40.0, 25.0, 60.0])


def a_part() -> Mesh:
    """A box with a ball stuck to one side, so that no axis can be mistaken for another."""
    solid = trimesh.util.concatenate(
        [
            trimesh.creation.box(SIZE),
            trimesh.creation.icosphere(2, 9.0).apply_translation([20, 5, 8]),
        ]
    )
    return Mesh.with_one_appearance(
        np.array(solid.vertices, float) + OFFSET, solid.faces.astype(np.int32)
    )


def save_as_part(folder: Path, mesh: Mesh) -> None:
    extents = tuple(float(e) for e in np.ptp(mesh.vertices, axis=0))
    folder.mkdir()
    save_part(folder, unit_part(extents_mm=extents), mesh)


@pytest.fixture(scope="session")
def params() -> Params:
    """params.yaml as it is."""
    return load_params(Path(__file__).parents[2] / "params.yaml")


@pytest.fixture(scope="session")
def rendered_part(tmp_path_factory: pytest.TempPathFactory, params: Params) -> Path:
    """A folder with `part` and `views`: 14 photographs of 64 px, 2 of them held out."""
    folder = tmp_path_factory.mktemp("photographed")
    save_as_part(folder / "part", a_part())
    small = replace(params.views, count=12, held_out=2, resolution=64)
    render_part(folder / "part", folder / "views", small, params.seed)
    return folder
