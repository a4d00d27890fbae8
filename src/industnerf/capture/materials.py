"""What every face is made of, as a shader reads it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, UInt8

from industnerf.artifacts.finish import Finish
from industnerf.artifacts.part import Mesh
from industnerf.errors import BadArtifact


@dataclass(frozen=True)
class Materials:
    """The finishes that a mesh uses, and which of them each face has."""

    of_face: UInt8[np.ndarray, "faces"]
    albedo: tuple[tuple[float, ...], ...]  # linear, one triple a finish in use
    metallic: Float32[np.ndarray, "used"]
    roughness: Float32[np.ndarray, "used"]

    @staticmethod
    def of(mesh: Mesh, finishes: Sequence[Finish], unstated: Sequence[float]) -> "Materials":
        """Those of `mesh`; a finish that states no albedo has `unstated`.

        Raises BadArtifact if a face has a finish that is not among `finishes`.
        """
        used, of_face = np.unique(mesh.finish, return_inverse=True)
        if used[-1] >= len(finishes):
            raise BadArtifact(
                f"a face has finish {used[-1]}, but part.json lists {len(finishes)} finishes, "
                "counted from 0; `dvc repro -f parts` writes both anew"
            )
        chosen = [finishes[i] for i in used]
        return Materials(
            of_face.astype(np.uint8),
            tuple(tuple(unstated if f.albedo is None else f.albedo) for f in chosen),
            np.array([finish.metallic for finish in chosen], np.float32),
            np.array([finish.roughness for finish in chosen], np.float32),
        )
