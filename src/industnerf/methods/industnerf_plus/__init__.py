"""`industnerf_plus`: the paper's method with additions of ours, told the background's color.

`pipeline` puts the additions together: silhouettes carve empty space (`silhouette_carving`) and
set the resolution (`adaptive_resolution`), points hold signed distances inside the visual hull
(`sdf_constraints`), which start at the photo hull (`photo_hull`), levels refine the cells beside
the surface (`narrow_band`), and colors are trained alone at the end (`color_refinement`).
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
