"""Whether a result is the part, or something else that was in view.

A method that finds no outline leaves all of the region of interest solid: most of its points lie
on the ball's rim, and many of them no photograph shows.  Where the ground differs from what counts
as background, the result is a piece of the scene as large as the region, and the photographs show
far more that differs from the background than the result covers.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int16

from industnerf.geometry.silhouettes import distance_to_mask
from industnerf.reconstruct.silhouette_check import Silhouettes

RIM = 0.97  # of the region's radius: farther out, a point is of the ball
# Between what was measured: 67 and 45 % for a scene with its surroundings, 30 and 19 % for a part.
MAX_RIM_SHARE = 0.5
MAX_UNSEEN_SHARE = 0.33
# Between what was measured: 21 to 37 % on cluttered or patterned ground, 100 % before one color.
MIN_COVERED_SHARE = 0.6
MARGIN_PX = 2.0  # beyond its outline that a result covers, in images that are reduced


@dataclass(frozen=True)
class ResultShares:
    """Which shares speak for the ball, or for something else than a part."""

    rim: float  # of the points, beyond RIM of the radius
    unseen: float  # of the points, seen by no photograph
    covered: float = 1.0  # of the silhouettes, by the result; 1 where masks tell the outline

    @property
    def is_no_part(self) -> bool:
        """Whether the cloud is the region of interest, or a piece of the scene in it."""
        return self.is_ball or self.covered < MIN_COVERED_SHARE

    @property
    def is_ball(self) -> bool:
        """Whether the cloud is the region of interest."""
        return self.rim > MAX_RIM_SHARE or self.unseen > MAX_UNSEEN_SHARE


def result_shares(
    points: Float[np.ndarray, "n 3"],
    view: Int16[np.ndarray, "n"],
    center: Float[np.ndarray, "3"],
    radius: float,
    covered: float = 1.0,
) -> ResultShares:
    """The shares of `points`, of which `view` is -1 where no photograph shows them."""
    distance = np.linalg.norm(points - center, axis=1)
    return ResultShares(float((distance > RIM * radius).mean()), float((view < 0).mean()), covered)


def covered_share(silhouettes: Silhouettes, rendered: Bool[np.ndarray, "n h w"]) -> float:
    """The share of what differs from the background that a result covers, in [0, 1].

    `rendered` is where the result shows in the cameras of `silhouettes`.  It is that of the median
    photograph, so that a few that show the edge of a table do not count; 1 if none shows a thing.
    """
    shares = [
        float((distance_to_mask(shown)[mask] <= MARGIN_PX).mean())
        for mask, shown in zip(silhouettes.masks, rendered, strict=True)
        if mask.any()
    ]
    return float(np.median(shares)) if shares else 1.0


def no_part_warning(shares: ResultShares) -> str:
    """What the result is, how that is known, and what to do."""
    if shares.is_ball:
        reason = (
            f"the result is the region of interest and not the part: {shares.rim:.0%} of its "
            f"points lie beyond {RIM:g} of the region's radius (a part: at most "
            f"{MAX_RIM_SHARE:.0%}) and {shares.unseen:.0%} are seen by no photograph (at most "
            f"{MAX_UNSEEN_SHARE:.0%})"
        )
    else:
        reason = (
            f"the result is a piece of the scene and not the part: it covers {shares.covered:.0%} "
            "of what differs from the background in a photograph (a part: at least "
            f"{MIN_COVERED_SHARE:.0%})"
        )
    return (
        f"{reason}. Something else than the part is in view: cut the part out (mask_path, or "
        "transparent pixels), photograph it before one plain color, or narrow the region by "
        "--center and --radius"
    )
