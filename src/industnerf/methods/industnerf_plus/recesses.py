"""Recesses along the normal of a face: bores, pockets, sockets and whole profiles.

Most recesses of machined and extruded parts have walls at right angles to the face that they open
in.  So each mouth in a face (`face_maps`) is cut down to several depths.  A cut stays if all
pictures together, rendered anew where it changes them, look more like the photographs; those that
gain most come first, for one recess may open what another one would fake.

A floor is flat, and its depth is one of a list, refined.
"""

import heapq
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float32
from scipy.ndimage import map_coordinates

from industnerf.methods.industnerf_plus.face_maps import (
    MIN_TOLERANCE,
    TOLERANCE,
    FaceMap,
    end_lattice,
    map_face,
)
from industnerf.methods.industnerf_plus.faces import find_faces
from industnerf.methods.industnerf_plus.pictures import Pictures
from industnerf.methods.industnerf_plus.shaded_surface import PinholeRays, ShadedSurface
from industnerf.methods.industnerf_plus.trials import Change, Trials
from industnerf.schema.industnerf import RecessSettings

DEPTHS = (3.0, 5.0, 8.0, 12.0, 18.0, 26.0, 38.0, 56.0, 80.0, 115.0)  # cells
REFINED_DEPTHS = (0.82, 0.91, 1.1, 1.2)  # of the best one
THROUGH = 4.0  # cells beyond the hull
MIN_THICKNESS = 3.0  # cells
THICKNESS_STEP, MAX_THICKNESS = 2.0, 400.0  # cells
FIRST_GROWTH, GROWTH_STEPS = -0.6, (0.6, 0.25)  # cells; pixels at a rim mix in what is beside it
MAX_STEPS = 4
HEAD = 2.0  # cells above the face that are cut too
MAX_MOUTHS = 60  # of a face
ALL_PIXELS = 1 << 30


@dataclass(frozen=True)
class Recess:
    """A mouth, and how deep and wide it is cut (cells)."""

    face_map: FaceMap
    outline: Float32[np.ndarray, "u v"]  # distance to the border of the mouth, > 0 inside
    thickness: float  # of the hull under the mouth
    max_cost_ratio: float
    depth: float = 0.0
    growth: float = FIRST_GROWTH

    def inside(self, points: Float32[np.ndarray, "n 3"]) -> Float32[np.ndarray, "n"]:
        """Distance to the sides of what is cut, > 0 inside."""
        across = self.face_map.look_up(self.outline, points) + np.float32(self.growth)
        height = self.face_map.height(points)
        along = np.minimum(height + np.float32(self.depth), np.float32(HEAD) - height)
        return np.minimum(across, along)

    def box(self, size: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First nodes and those after the last of what may be cut, in a grid of this size."""
        rim = self.face_map.points(self.outline > -3)
        ends = np.concatenate(
            [rim + h * self.face_map.face.normal for h in (-self.depth - 2, HEAD)]
        )
        lo = np.maximum(np.floor(ends.min(axis=0)).astype(int) - 1, 2)
        return lo, np.minimum(np.ceil(ends.max(axis=0)).astype(int) + 2, size - 2)


def cut_recesses(
    surface: ShadedSurface, rays: PinholeRays, pictures: Pictures, settings: RecessSettings
) -> int:
    """Change `surface`, whose light is fitted, where the pictures agree; returns how often."""
    if surface.finishes is None or not settings.faces:
        return 0
    trials = Trials(surface, rays, pictures)
    faces = find_faces(surface, settings.faces)
    if not faces:
        return 0
    brightest = surface.finishes.lighting.brightness(
        np.array([face.normal for face in faces])
    ).max()
    tolerance = max(MIN_TOLERANCE, TOLERANCE * float(brightest))
    ends = end_lattice(trials)
    cutter = _Cutter(trials, settings.rays_per_trial)
    for face in faces:
        face_map = map_face(trials, face, ends, tolerance)
        if face_map is None:
            continue
        for outlines, ratio in (
            (face_map.mouths(), settings.max_cost_ratio),
            (face_map.gaps(), settings.max_gap_cost_ratio),
        ):
            for outline in outlines[:MAX_MOUTHS]:
                cutter.propose(face_map, outline, ratio)
    number = cutter.cut()
    if number:
        surface.redistance()
    return number


class _Cutter:
    """Recesses in the order of what they gain."""

    def __init__(self, trials: Trials, rays_per_trial: int) -> None:
        self._trials, self._rays_per_trial = trials, rays_per_trial
        self._heap: list[tuple[float, int, Recess]] = []

    def propose(
        self, face_map: FaceMap, outline: Float32[np.ndarray, "u v"], max_cost_ratio: float
    ) -> None:
        """Find the depth and width of the mouth that gain most, if any do."""
        thickness = hull_thickness(self._trials, face_map, outline)
        if thickness < MIN_THICKNESS:
            return
        recess = Recess(face_map, outline, thickness, max_cost_ratio)
        depths = [*(d for d in DEPTHS if d < thickness), thickness + THROUGH]
        gain, recess = self._best([replace(recess, depth=depth) for depth in depths])
        if gain <= 0:
            return
        gain, recess = self._resized(gain, recess, GROWTH_STEPS[0])
        if recess.depth < thickness:
            factors = (1.0, *REFINED_DEPTHS)
            gain, recess = self._best([replace(recess, depth=f * recess.depth) for f in factors])
        gain, recess = self._resized(gain, recess, GROWTH_STEPS[1])
        heapq.heappush(self._heap, (-gain, len(self._heap), recess))

    def _best(self, recesses: list[Recess]) -> tuple[float, Recess]:
        gains = [self._gain(recess) for recess in recesses]
        best = int(np.argmax(gains))
        return gains[best], recesses[best]

    def _resized(self, gain: float, recess: Recess, step: float) -> tuple[float, Recess]:
        """Narrower by steps, or else wider, as long as that gains."""
        first = recess.growth
        for direction in (-step, step):
            for _ in range(MAX_STEPS):
                trial = replace(recess, growth=recess.growth + direction)
                trial_gain = self._gain(trial)
                if trial_gain <= gain:
                    break
                gain, recess = trial_gain, trial
            if recess.growth != first:
                break
        return gain, recess

    def cut(self) -> int:
        """Cut those that still gain, the best first; returns how many."""
        accepted = 0
        while self._heap:
            _, number, recess = heapq.heappop(self._heap)
            gain = self._gain(recess)  # after what was cut meanwhile
            if self._heap and gain < -self._heap[0][0]:
                if gain > 0:
                    heapq.heappush(self._heap, (-gain, number, recess))
                continue
            accepted += self._gain(recess, keep=True) > 0
        return accepted

    def _gain(self, recess: Recess, keep: bool = False) -> float:
        """How much less all judging pixels cost, estimated by some, or by all to `keep` it."""
        trials = self._trials
        lo, hi = recess.box(np.array(trials.distance.shape))
        if (hi - lo < 2).any():
            return 0.0
        box = tuple(slice(a, b) for a, b in zip(lo, hi, strict=True))
        nodes = np.argwhere(trials.distance[box] < HEAD + 0.5) + lo
        before = trials.distance[tuple(nodes.T)]
        change = Change.of(
            nodes, before, np.maximum(before, recess.inside(nodes.astype(np.float32)))
        )
        if change is None:
            return 0.0
        ending = trials.ending_in(lo, hi, recess.inside, ALL_PIXELS)
        stride = 1 if keep else len(ending) // self._rays_per_trial + 1
        verdict = trials.attempt(change, ending[::stride], recess.max_cost_ratio, keep)
        return stride * verdict.gain if verdict else 0.0


def hull_thickness(trials: Trials, face_map: FaceMap, outline: Float32[np.ndarray, "u v"]) -> float:
    """How deep the hull goes under the mouth before all of it is outside again (cells)."""
    points = face_map.points(outline > 0)
    points = points[:: max(1, len(points) // 60)]
    size, thickness = np.array(trials.distance.shape), 0.0
    for depth in np.arange(THICKNESS_STEP, MAX_THICKNESS, THICKNESS_STEP):
        below = points - depth * face_map.face.normal
        is_in_grid = ((below >= 2) & (below <= size - 3)).all(axis=1)
        hull = map_coordinates(trials.surface.grid.hull, below.T, order=1, cval=9.0)
        if (is_in_grid & (hull < -0.5)).any():
            thickness = float(depth)
        elif thickness or not is_in_grid.any():
            break  # the hull of a gap starts farther down
    return thickness
