"""`industnerf_plus`: the paper's method with additions of ours, told the background's color.

`pipeline` puts the additions together.  The field is trained as the paper's, on points inside the
visual hull (`silhouette_carving`, `adaptive_resolution`) that hold signed distances
(`sdf_constraints`) and start at the photo hull (`photo_hull`).  Its surface goes to a grid of its
own (`distance_grid`), where light and finishes are fitted (`lighting`, `finishes`) and shading
polishes it (`polish`, with `shaded_surface` and its kernels).  `surface_cloud`, `appearance` and
`rerender` give the cloud, its confidence and pictures.
"""

from industnerf.methods.base import Input, Method, MethodInputs, Reconstruction, Scope
from industnerf.methods.industnerf import run_on_inputs
from industnerf.schema import IndustnerfPlusSettings


def reconstruct(
    inputs: MethodInputs, settings: IndustnerfPlusSettings, state: None, seed: int
) -> Reconstruction:
    """From images, cameras and the color behind the part."""
    # late: a report that names the method need not wait for torch
    from industnerf.methods.industnerf_plus.pipeline import run

    return run_on_inputs(run, inputs, settings, seed, background=inputs.background)


METHODS = {
    "industnerf_plus": Method(
        "industnerf_plus",
        Scope.PART,
        frozenset({Input.RGB, Input.BACKGROUND}),
        reconstruct,
        is_stochastic=True,
    )
}
