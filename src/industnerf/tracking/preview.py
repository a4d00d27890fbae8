"""A picture of what a method made of some parts."""

from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from PIL import Image

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.renderings import Renderings
from industnerf.artifacts.views import load_views
from industnerf.splats import splat

MAX_PREVIEW_PARTS = 4  # parts in a picture
MAX_PREVIEW_PX = 256  # the side of one of its images: a megabyte a method would take seconds


def preview_image(clouds: Path, views: Path) -> UInt8[np.ndarray, "h w 3"] | None:
    """A few parts from their first held-out camera: left the photograph, right what was made of it.

    That is the rendering, or of a method that does not render the points of the cloud.  None if
    there is no cloud or no held-out camera.  Raises BadArtifact if a file is missing or torn.
    """
    clouds_with_views = [path.parent for path in sorted(clouds.glob("*/cloud.npz"))]
    clouds_with_views = [
        cloud for cloud in clouds_with_views if load_views(views / cloud.name).held_out.any()
    ]
    selected = clouds_with_views[:: -(-len(clouds_with_views) // MAX_PREVIEW_PARTS) or 1]
    rows = [_side_by_side(cloud, views / cloud.name) for cloud in selected]
    return np.concatenate(rows) if rows else None


def _side_by_side(cloud: Path, views: Path) -> UInt8[np.ndarray, "h w 3"]:
    view_set = load_views(views)
    cameras, first = view_set.cameras, np.flatnonzero(view_set.held_out)[:1]
    height = min(cameras.height, MAX_PREVIEW_PX)
    rendering = Renderings.load_first_rgb(cloud)
    if rendering is None:
        loaded_cloud = Cloud.load(cloud)
        rendering = splat(
            loaded_cloud.points_mm, loaded_cloud.colors, cameras, int(first[0]), height
        )
    images = [_resize(image, height) for image in (view_set.rgb(first)[0], rendering)]
    return np.concatenate(images, axis=1)


def _resize(image: UInt8[np.ndarray, "h w 3"], height: int) -> UInt8[np.ndarray, "h2 w2 3"]:
    if len(image) == height:
        return image
    width = round(image.shape[1] * height / len(image))
    return np.asarray(Image.fromarray(image).resize((width, height), Image.Resampling.BOX))
