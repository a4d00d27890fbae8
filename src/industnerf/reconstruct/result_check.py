"""Whether a result is the part, or the ball in which it was looked for.

A method that finds no outline leaves all of the region of interest solid: most of its points lie
on the ball's rim, and many of them no photograph shows.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int16

RIM = 0.97  # of the region's radius: farther out, a point is of the ball
# Between what was measured: 67 and 45 % for a scene with its surroundings, 30 and 19 % for a part.
MAX_RIM_SHARE = 0.5
MAX_UNSEEN_SHARE = 0.33


@dataclass(frozen=True)
class RegionShares:
    """Which shares of a cloud speak for the ball and not for a part."""

    rim: float  # beyond RIM of the radius
    unseen: float  # seen by no photograph

    @property
    def is_ball(self) -> bool:
        """Whether the cloud is the region of interest rather than a part in it."""
        return self.rim > MAX_RIM_SHARE or self.unseen > MAX_UNSEEN_SHARE


def region_shares(
    points: Float[np.ndarray, "n 3"],
    view: Int16[np.ndarray, "n"],
    center: Float[np.ndarray, "3"],
    radius: float,
) -> RegionShares:
    """The shares of `points`, of which `view` is -1 where no photograph shows them."""
    distance = np.linalg.norm(points - center, axis=1)
    return RegionShares(float((distance > RIM * radius).mean()), float((view < 0).mean()))


def ball_warning(shares: RegionShares) -> str:
    """What the result is, how that is known, and what to do."""
    return (
        f"the result is the region of interest and not the part: {shares.rim:.0%} of its points "
        f"lie beyond {RIM:g} of the region's radius (a part: at most {MAX_RIM_SHARE:.0%}) and "
        f"{shares.unseen:.0%} are seen by no photograph (at most {MAX_UNSEEN_SHARE:.0%}). "
        "Something else than the part is in view: cut the part out (mask_path, or transparent "
        "pixels), photograph it before one plain color, or narrow the region by --center and "
        "--radius"
    )
