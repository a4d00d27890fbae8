"""The material of every face, as the shading reads it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, UInt8

from industnerf.artifacts.part import Appearance, Mesh
from industnerf.errors import BadArtifact


@dataclass(frozen=True)
class Materials:
    """The appearances that a mesh uses, and which of them each face has."""

    face_material: UInt8[np.ndarray, "faces"]
    albedo: tuple[tuple[float, ...], ...]  # linear, one triple an appearance in use
    metallic: Float32[np.ndarray, "used"]
    roughness: Float32[np.ndarray, "used"]

    @staticmethod
    def from_mesh(
        mesh: Mesh, appearances: Sequence[Appearance], default_albedo: Sequence[float]
    ) -> "Materials":
        """Those of `mesh`; an appearance that states no albedo has `default_albedo`.

        Raises BadArtifact if a face has an appearance that is not among `appearances`.
        """
        used, face_material = np.unique(mesh.finish, return_inverse=True)
        if used[-1] >= len(appearances):
            raise BadArtifact(
                f"a face has finish {used[-1]}, but part.json lists {len(appearances)} finishes, "
                "counted from 0; `dvc repro -f parts` writes both anew"
            )
        used_appearances = [appearances[i] for i in used]
        return Materials(
            face_material.astype(np.uint8),
            tuple(
                tuple(default_albedo if one.albedo is None else one.albedo)
                for one in used_appearances
            ),
            np.array([appearance.metallic for appearance in used_appearances], np.float32),
            np.array([appearance.roughness for appearance in used_appearances], np.float32),
        )
