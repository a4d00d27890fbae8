"""The embedded parts never pass through cleaning: here they show that it leaves sound parts alone.

Among them are threads whose crests come nearer than the weld, cavities, and tiny loose balls.
"""

import numpy as np
import pytest

from industnerf.parts.catalogue.entries import load_catalogue_mesh, read_catalogue
from industnerf.parts.repair import repair_mesh
from tests.parts.repair.shapes import settings


@pytest.mark.slow
def test_embedded_parts_are_left_as_they_are():
    entries = read_catalogue()[::5]  # all of them take a minute
    for entry in entries:
        mesh = load_catalogue_mesh(entry)
        cleaned = repair_mesh([mesh], settings())
        assert (entry.id, cleaned.repairs, cleaned.residual_defects) == (entry.id, (), ())
        np.testing.assert_array_equal(cleaned.mesh.faces, mesh.faces)
        np.testing.assert_array_equal(cleaned.mesh.finish, mesh.finish)
        # There and back are two roundings, of a coordinate of at most a few diagonals.
        np.testing.assert_allclose(
            cleaned.mesh.vertices, mesh.vertices, rtol=1e-15, atol=1e-15 * np.ptp(mesh.vertices)
        )
    assert entries
