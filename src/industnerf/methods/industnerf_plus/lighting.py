"""Light, fitted to the pixels of a surface with known normals: brightness = shading by n.

    brightness(n) = ambient + sum_k max(0, n . light_k)

The lights are those of a few directions that explain most pixels.  Fit: non-negative least
squares over many directions, reweighted so that outliers do not count; neighbors are merged; the
few that are left are refined.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares, nnls

from industnerf.geometry.sphere import fibonacci_sphere

NUM_DIRECTIONS = 200  # of lights to choose from
REWEIGHTINGS = 4
OUTLIER_SCALE = 0.02  # residual at which a pixel counts half
REFINE_SCALE = 0.01  # residual from which a pixel counts less in the refinement
MERGE_DEG = 20.0  # lights nearer than this are one
MAX_LIGHTS = 6
MIN_INTENSITY = 0.01  # of a light that is kept; brightness is in [0, 1]
NUM_REFINED_PIXELS = 4000


@dataclass(frozen=True)
class Lighting:
    """Ambient light, and lights with their intensity as length; albedo is part of both."""

    ambient: float
    lights: Float[np.ndarray, "k 3"]

    def brightness(self, normals: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n"]:
        return self.ambient + np.maximum(normals @ self.lights.T, 0).sum(axis=1)


def fit_lighting(
    normals: Float[np.ndarray, "n 3"],
    brightness: Float[np.ndarray, "n"],
    weights: Float[np.ndarray, "n"] | None = None,
) -> Lighting:
    """The light under which the normals look as bright."""
    directions = fibonacci_sphere(NUM_DIRECTIONS)
    basis = np.concatenate(
        [np.ones((len(normals), 1)), np.maximum(normals @ directions.T, 0)], axis=1
    )
    prior = np.ones(len(brightness)) if weights is None else weights
    weights = prior
    for _ in range(REWEIGHTINGS):
        gram = (basis * weights[:, None]).T @ basis
        gram += 1e-7 * np.trace(gram) / len(gram) * np.eye(len(gram))
        cholesky = np.linalg.cholesky(gram)
        projected = np.linalg.solve(cholesky, (basis * weights[:, None]).T @ brightness)
        solution, _ = nnls(cholesky.T, projected)
        residual = basis @ solution - brightness
        weights = prior / (1 + (residual / OUTLIER_SCALE) ** 2)
    lights = merge_lights(directions * solution[1:, None])
    return refine_lighting(Lighting(float(solution[0]), lights), normals, brightness)


def refine_lighting(
    lighting: Lighting,
    normals: Float[np.ndarray, "n 3"],
    brightness: Float[np.ndarray, "n"],
) -> Lighting:
    """The best light near `lighting`."""
    chosen = np.random.default_rng(0).permutation(len(brightness))[:NUM_REFINED_PIXELS]
    sample, target = normals[chosen], brightness[chosen]

    def misfit(x):
        return x[0] + np.maximum(sample @ x[1:].reshape(-1, 3).T, 0).sum(axis=1) - target

    def jacobian(x):
        lit = sample @ x[1:].reshape(-1, 3).T > 0
        rows = lit[:, :, None] * sample[:, None]
        return np.column_stack([np.ones(len(sample)), rows.reshape(len(sample), -1)])

    refined = least_squares(
        misfit,
        np.concatenate([[lighting.ambient], lighting.lights.ravel()]),
        jac=jacobian,
        loss="cauchy",
        f_scale=REFINE_SCALE,
        max_nfev=30,
    ).x
    lights = refined[1:].reshape(-1, 3)
    lights = lights[np.linalg.norm(lights, axis=1) > MIN_INTENSITY]
    return Lighting(float(refined[0]), lights)


def merge_lights(lights: Float[np.ndarray, "k 3"]) -> Float[np.ndarray, "_ 3"]:
    """The strongest lights, each with those near it."""
    intensity = np.linalg.norm(lights, axis=1)
    remaining = [int(i) for i in np.argsort(-intensity) if intensity[i] > 1e-3]
    merged = []
    while remaining:
        direction = lights[remaining[0]] / intensity[remaining[0]]
        near = [
            i
            for i in remaining
            if lights[i] @ direction > np.cos(np.radians(MERGE_DEG)) * intensity[i]
        ]
        merged.append(lights[near].sum(axis=0))
        remaining = [i for i in remaining if i not in near]
    merged.sort(key=lambda light: -np.linalg.norm(light))
    return np.array(merged[:MAX_LIGHTS]).reshape(-1, 3)
