"""Shading like a photograph's: metal shines, shadows are soft, and both depend on the view.

Light is reflected twice over: by the surface like a mirror's (Cook-Torrance with the GGX
distribution, Walter et al. 2007, and Schlick's Fresnel term) and, unless it is metal, from below
it in all directions.  Radiance is counted in the units of matte shading: a lamp of intensity 1
makes a white matte face that it stands upright on send 1.

A metal shows its surroundings, and before three discs in an even sky it would be black with white
spots.  So a lamp is a disc before a bright wall: for mirrors, a `GLOW` of its light comes from all
the half of the sky around it, most from the middle.
"""

import numpy as np
from jaxtyping import Float32

from industnerf.capture.light import Lamps
from industnerf.capture.materials import Materials
from industnerf.capture.shading import Shading
from industnerf.capture.shadows import Shadows
from industnerf.capture.surface import Spots, Surface
from industnerf.schema import PhotoParams

DIELECTRIC = np.float32(0.04)  # what paint and plastic mirror straight on: index 1.5
DULLEST = np.float32(1e-3)  # least width of a highlight: a perfect mirror has no finite one
GLOW = np.float32(0.5)
GRAZING = np.float32(1e-3)  # least cosine: a smooth normal may turn away from the eye

Scalar = Float32[np.ndarray, "n"]
Colour = Float32[np.ndarray, "3 n"]


class Photo(Shading):
    """A part's materials under the lamps of one view."""

    tint = (1.0, 1.0, 1.0)

    def __init__(
        self, surface: Surface, materials: Materials, lamps: Lamps, photo: PhotoParams
    ) -> None:
        self._lamps, self._of_face = lamps, materials.of_face
        self._shadows = Shadows(surface, photo.lamp_deg, photo.shadow_samples)
        self._spread = np.float32(np.tan(np.radians(photo.lamp_deg)) / 2)
        albedo = np.array(materials.albedo, np.float32).T
        self._mirrored = DIELECTRIC + materials.metallic * (albedo - DIELECTRIC)
        self._diffuse = (1 - materials.metallic) * albedo
        self._roughness = materials.roughness

    def __call__(self, spots: Spots) -> Float32[np.ndarray, "channels spots"]:
        made_of = self._of_face.take(spots.face)
        mirrored, diffuse = self._mirrored[:, made_of], self._diffuse[:, made_of]
        roughness = self._roughness.take(made_of)
        normal = spots.normal / np.maximum(length(spots.normal), np.float32(1e-12))
        starts = self._shadows.starts(spots, normal)
        eye = (spots.eye - starts).T.astype(np.float32)
        eye /= length(eye)
        facing = np.maximum(dot(normal, eye), GRAZING)
        shine = sheen(mirrored, roughness, facing)
        below = diffuse * (1 - shine)  # what is not mirrored on its way out, nor on its way in
        light = self._lamps.ambient * (below + shine)
        seen_in_mirror = 2 * dot(normal, eye) * normal - eye
        width = np.minimum(np.maximum(roughness**2, DULLEST) + self._spread, 1)
        for towards, intensity in zip(self._lamps.towards, self._lamps.intensity, strict=True):
            lit = self._shadows.lit(starts, normal, towards)
            cosine = np.maximum(towards @ normal, GRAZING)
            gloss = highlight(towards, eye, normal, mirrored, width)
            light += intensity * lit.cosine * below * (1 - sheen(mirrored, roughness, cosine))
            glow = np.maximum(towards @ seen_in_mirror, 0) * shine
            light += intensity * lit.share * (gloss + GLOW * (glow - gloss))
        return light


def highlight(
    towards: Float32[np.ndarray, "3"], eye: Colour, normal: Colour, mirrored: Colour, width: Scalar
) -> Colour:
    """What a lamp of intensity 1 is mirrored as: pi D F G / (4 n.v), all vectors of unit length.

    D is the GGX distribution of slopes of the given `width`, which a lamp's own width adds to;
    G is Smith's shadowing and masking, correlated in height.
    """
    half = towards[:, None] + eye
    half /= np.maximum(length(half), np.float32(1e-12))
    square = width * width
    slope = dot(normal, half) ** 2 * (square - 1) + 1
    facing, cosine = np.maximum(dot(normal, eye), GRAZING), np.maximum(towards @ normal, 0)
    masked = cosine * np.sqrt(facing**2 * (1 - square) + square)
    masked += facing * np.sqrt(cosine**2 * (1 - square) + square)
    scattered = square / slope**2 * np.float32(0.5) / masked * cosine
    return scattered * fresnel(mirrored, np.maximum(dot(half, eye), 0))


def fresnel(mirrored: Colour, cosine: Scalar) -> Colour:
    """The share that is mirrored at this angle, `mirrored` being that straight on -- Schlick."""
    return mirrored + (1 - mirrored) * (1 - cosine) ** 5


def sheen(mirrored: Colour, roughness: Scalar, facing: Scalar) -> Colour:
    """The share of an even sky that is mirrored; a rough surface shines less where it slants."""
    rim = np.maximum(1 - roughness, mirrored)
    return mirrored + (rim - mirrored) * (1 - facing) ** 5


def dot(a: Colour, b: Colour) -> Scalar:
    return np.einsum("ij,ij->j", a, b)


def length(vectors: Colour) -> Scalar:
    return np.sqrt(dot(vectors, vectors))
