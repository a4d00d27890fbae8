"""Whether the photographs agree on where the part is, as far as color tells it from its background.

The part is unknown.  But what differs from the background in one photograph lies within the visual
hull of all, if each shows all of the part so.  Where a photograph loses some of the part, because
it is as light as the background, the hull loses it too, and the others show more than the hull.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int64, UInt8

from industnerf.geometry.cameras import (
    Cameras,
    common_view_ball,
    nested_view_subset,
    project,
)
from industnerf.geometry.silhouettes import (
    border,
    differs_from_background,
    distance_to_mask,
    foreground_mask,
)
from industnerf.reconstruct.pose_outliers import exclude_option

TOLERANCE = 0.02  # in [0, 1]; as method.industnerf_plus.background_tolerance
LONG_EDGE_PX = 128  # of the images that are looked at
GRID_RES = 48  # voxels a side of the cube around the region of interest
MARGIN_PX = 1.5  # beyond half a voxel's diagonal: an outline covers pixels, not their centers
MIN_PLAIN_SHARE = 0.75  # of a border within TOLERANCE of its median, for a plain background
MIN_VIEWS, MAX_VIEWS = 3, 24  # before a plain background; of more, so many that are far apart
MAX_LOST_SHARE = 0.02  # of what differs from the background: more is warned of
MAX_SUSPECTS = 3  # photographs that are left out, each alone, to see if the others agree


@dataclass(frozen=True)
class Silhouettes:
    """What differs from the background in the photographs before a plain one, reduced."""

    masks: Bool[np.ndarray, "n h w"]
    cameras: Cameras
    views: Int64[np.ndarray, "n"]  # which photographs they are of


def plain_silhouettes(
    rgb: UInt8[np.ndarray, "n h w 3"],
    cameras: Cameras,
    background: Float[np.ndarray, "n 3"] | None,
) -> Silhouettes | None:
    """Those of up to MAX_VIEWS photographs, or None if fewer than MIN_VIEWS are plain.

    `background` is that of each photograph, in [0, 1]; None: the median of its border.
    """
    if background is None:
        background = np.stack([np.median(border(image), axis=0) / 255 for image in rgb])
    is_plain = np.array(
        [_is_plain(image, color) for image, color in zip(rgb, background, strict=True)]
    )
    if is_plain.sum() < MIN_VIEWS:
        return None
    return silhouettes_of(np.flatnonzero(is_plain), rgb, cameras, background)


def silhouettes_of(
    views: Int64[np.ndarray, "n"],
    rgb: UInt8[np.ndarray, "all h w 3"],
    cameras: Cameras,
    background: Float[np.ndarray, "all 3"],
) -> Silhouettes:
    """Those of up to MAX_VIEWS of `views`, far apart; `background` is in [0, 1]."""
    positions = cameras.centers[views]
    views = views[nested_view_subset(positions, min(len(views), MAX_VIEWS))]
    images, cameras = _reduce(rgb[views], cameras[views])
    return Silhouettes(foreground_mask(images, background[views], TOLERANCE), cameras, views)


def silhouette_warning(
    silhouettes: Silhouettes,
    center: Float[np.ndarray, "3"],
    radius: float,
    names: Sequence[str] = (),
) -> str | None:
    """A sentence if more than MAX_LOST_SHARE of the silhouettes lie outside their visual hull.

    It names the photograph, of `names`, without which they would not.
    """
    share = lost_share(silhouettes.masks, silhouettes.cameras, center, radius)
    if share <= MAX_LOST_SHARE:
        return None
    text = (
        f"{share:.0%} of what differs from the background lies where another photograph shows the "
        "background: "
    )
    odd = odd_silhouette(silhouettes, center, radius) if names else None
    if odd is not None:
        return (
            f"{text}it is {names[odd]} that contradicts all others: a wrong pose? Leave it out by "
            f"{exclude_option(names, [odd])}"
        )
    return (
        f"{text}the part is as light as what is behind it, or cameras are wrong, or something "
        "else is in view; the part comes out eroded (photograph it before another color, or cut "
        "it out, with --background)"
    )


def odd_silhouette(
    silhouettes: Silhouettes, center: Float[np.ndarray, "3"], radius: float
) -> int | None:
    """The one photograph without which the others agree, if there is one.

    Those that alone see most of the region empty are tried: MAX_SUSPECTS of them.
    """
    masks, cameras = silhouettes.masks, silhouettes.cameras
    sees_empty = ~_sees_solid(masks, cameras, center, radius)
    alone = (sees_empty & (sees_empty.sum(axis=0) == 1)).sum(axis=1)
    for suspect in np.argsort(-alone, kind="stable")[:MAX_SUSPECTS]:
        others = np.delete(np.arange(len(masks)), suspect)
        if len(others) < MIN_VIEWS:
            return None
        if lost_share(masks[others], cameras[others], center, radius) <= MAX_LOST_SHARE:
            return int(silhouettes.views[suspect])
    return None


def agree_once_transposed(silhouettes: Silhouettes) -> bool:
    """Whether the silhouettes agree where all cameras are as `transpose_rotations` has them."""
    cameras = silhouettes.cameras
    cameras = replace(cameras, c2w=transpose_rotations(cameras.c2w))
    region = common_view_ball(cameras)
    return lost_share(silhouettes.masks, cameras, *region) <= MAX_LOST_SHARE


def transpose_rotations(c2w: Float[np.ndarray, "n 4 4"]) -> Float[np.ndarray, "n 4 4"]:
    """Poses of a file whose world-to-camera translations are right and rotations transposed."""
    swapped = c2w.copy()
    swapped[:, :3, :3] = c2w[:, :3, :3].transpose(0, 2, 1)
    turned = swapped[:, :3, :3] @ swapped[:, :3, :3]
    swapped[:, :3, 3] = np.einsum("nij,nj->ni", turned, c2w[:, :3, 3])
    return swapped


def _is_plain(image: UInt8[np.ndarray, "h w 3"], background: Float[np.ndarray, "3"]) -> bool:
    pixels = border(image)[None, None]
    return bool(
        1 - differs_from_background(pixels, background[None], TOLERANCE).mean() >= MIN_PLAIN_SHARE
    )


def _reduce(
    rgb: UInt8[np.ndarray, "n h w 3"], cameras: Cameras
) -> tuple[UInt8[np.ndarray, "n rows columns 3"], Cameras]:
    """Single pixels, evenly spaced: a mean of several would differ from the background."""
    step = -(-max(cameras.width, cameras.height) // LONG_EDGE_PX)
    reduced = rgb[:, ::step, ::step]
    # the center of the first pixel is the center of the first that is kept
    offset = 0.5 - 0.5 / step
    to_reduced = np.array([[1 / step, 0, offset], [0, 1 / step, offset], [0, 0, 1]])
    height, width = reduced.shape[1:3]
    return reduced, Cameras(to_reduced @ cameras.K, cameras.c2w, width, height)


def lost_share(
    masks: Bool[np.ndarray, "n h w"],
    cameras: Cameras,
    center: Float[np.ndarray, "3"],
    radius: float,
) -> float:
    """Of the `masks` within the region of interest, the share that their visual hull leaves out."""
    voxels, half_diagonal = _region_voxels(center, radius)
    is_in_hull = _sees_solid(masks, cameras, center, radius).all(axis=0)
    shown = lost = 0
    for mask, K, c2w in zip(masks, cameras.K, cameras.c2w, strict=True):
        u, v, in_frame, reach_px = _to_pixels(voxels, K, c2w, cameras, half_diagonal)
        covered = []
        for selected in (in_frame, in_frame & is_in_hull):
            hit = np.zeros(mask.shape, bool)
            hit[v[selected], u[selected]] = True
            covered.append(distance_to_mask(hit) <= reach_px[in_frame].max(initial=0.0))
        shown += int((mask & covered[0]).sum())
        lost += int((mask & covered[0] & ~covered[1]).sum())
    return lost / max(shown, 1)


def _sees_solid(
    masks: Bool[np.ndarray, "n h w"],
    cameras: Cameras,
    center: Float[np.ndarray, "3"],
    radius: float,
) -> Bool[np.ndarray, "n voxels"]:
    """Whether each mask leaves each voxel of the region, or does not show it."""
    voxels, half_diagonal = _region_voxels(center, radius)
    rows = []
    for mask, K, c2w in zip(masks, cameras.K, cameras.c2w, strict=True):
        u, v, in_frame, reach_px = _to_pixels(voxels, K, c2w, cameras, half_diagonal)
        rows.append(~in_frame | (distance_to_mask(mask)[v, u] <= reach_px))
    return np.stack(rows)


def _region_voxels(
    center: Float[np.ndarray, "3"], radius: float
) -> tuple[Float[np.ndarray, "m 3"], float]:
    """The centers of the voxels in the region of interest, and half the diagonal of one."""
    steps = (np.arange(GRID_RES) + 0.5) * (2 / GRID_RES) - 1
    unit = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    unit = unit[(unit**2).sum(axis=1) <= 1]
    return center + radius * unit, radius * np.sqrt(3) / GRID_RES


def _to_pixels(
    voxels: Float[np.ndarray, "m 3"],
    K: Float[np.ndarray, "3 3"],
    c2w: Float[np.ndarray, "4 4"],
    cameras: Cameras,
    half_diagonal: float,
) -> tuple[np.ndarray, np.ndarray, Bool[np.ndarray, "m"], Float[np.ndarray, "m"]]:
    """Column and row of each voxel's pixel, whether it is in frame, and how far (px) it reaches."""
    uv, depth = project(voxels, K, c2w)
    in_frame = (depth > half_diagonal) & (uv >= 0).all(axis=1)
    in_frame &= (uv < [cameras.width, cameras.height]).all(axis=1)
    u, v = np.where(in_frame[:, None], uv, 0).astype(int).T
    reach_px = MARGIN_PX + max(K[0, 0], K[1, 1]) * half_diagonal / np.where(in_frame, depth, 1.0)
    return u, v, in_frame, reach_px
