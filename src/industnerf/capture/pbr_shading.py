"""Physically based shading: metal shines, shadows are soft, and both depend on the view.

Light is reflected twice over: by the surface like a mirror's (Cook-Torrance with the GGX
distribution, Walter et al. 2007, and Schlick's Fresnel term) and, unless it is metal, from below
it in all directions.  Radiance is counted in the units of matte shading: a lamp of intensity 1
makes a white matte face that it stands upright on send 1.

A metal shows its surroundings, and before three discs in an even sky it would be black with white
spots.  So a lamp is a disc before a bright wall: for mirrors, a share GLOW_SHARE of its light comes
from all the half of the sky around it, most from the middle.
"""

import numpy as np
from jaxtyping import Float32

from industnerf.capture.light import Lights
from industnerf.capture.materials import Materials
from industnerf.capture.ray_hits import Surface, SurfacePoints
from industnerf.capture.shading import Shading
from industnerf.capture.shadows import Shadows
from industnerf.schema import PhotorealisticParams

DIELECTRIC_F0 = np.float32(0.04)  # what paint and plastic mirror straight on: index 1.5
MIN_ALPHA = np.float32(1e-3)  # least width of a highlight: a perfect mirror has no finite one
GLOW_SHARE = np.float32(0.5)
MIN_COSINE = np.float32(1e-3)  # least cosine: a smooth normal may turn away from the camera

Scalar = Float32[np.ndarray, "n"]
Color = Float32[np.ndarray, "3 n"]


class PbrShading(Shading):
    """A part's materials under the lamps of one view."""

    tint = (1.0, 1.0, 1.0)

    def __init__(
        self, surface: Surface, materials: Materials, lights: Lights, settings: PhotorealisticParams
    ) -> None:
        self._lights, self._face_material = lights, materials.face_material
        self._shadows = Shadows(surface, settings.light_half_angle_deg, settings.shadow_samples)
        self._lamp_alpha = np.float32(np.tan(np.radians(settings.light_half_angle_deg)) / 2)
        albedo = np.array(materials.albedo, np.float32).T
        self._f0 = DIELECTRIC_F0 + materials.metallic * (albedo - DIELECTRIC_F0)
        self._diffuse = (1 - materials.metallic) * albedo
        self._roughness = materials.roughness

    def __call__(self, hits: SurfacePoints) -> Float32[np.ndarray, "channels hits"]:
        material = self._face_material.take(hits.face)
        f0, diffuse = self._f0[:, material], self._diffuse[:, material]
        roughness = self._roughness.take(material)
        normal = hits.normal / np.maximum(length(hits.normal), np.float32(1e-12))
        ray_origins = self._shadows.ray_origins(hits, normal)
        view_dir = (hits.camera_center - ray_origins).T.astype(np.float32)
        view_dir /= length(view_dir)
        n_dot_v = np.maximum(dot(normal, view_dir), MIN_COSINE)
        view_reflectance = sky_reflectance(f0, roughness, n_dot_v)
        # what is not mirrored on its way out, nor, below, on its way in
        diffuse_out = diffuse * (1 - view_reflectance)
        radiance = self._lights.ambient * (diffuse_out + view_reflectance)
        mirror_dir = 2 * dot(normal, view_dir) * normal - view_dir
        alpha = np.minimum(np.maximum(roughness**2, MIN_ALPHA) + self._lamp_alpha, 1)
        for light_dir, intensity in zip(
            self._lights.directions, self._lights.intensity, strict=True
        ):
            visibility = self._shadows.light_visibility(ray_origins, normal, light_dir)
            n_dot_l = np.maximum(light_dir @ normal, MIN_COSINE)
            specular = ggx_specular(light_dir, view_dir, normal, f0, alpha)
            diffuse_in = 1 - sky_reflectance(f0, roughness, n_dot_l)
            radiance += intensity * visibility.mean_cosine * diffuse_out * diffuse_in
            glow = np.maximum(light_dir @ mirror_dir, 0) * view_reflectance
            mirrored = specular + GLOW_SHARE * (glow - specular)
            radiance += intensity * visibility.visible_share * mirrored
        return radiance


def ggx_specular(
    light_dir: Float32[np.ndarray, "3"], view_dir: Color, normal: Color, f0: Color, alpha: Scalar
) -> Color:
    """What a lamp of intensity 1 is mirrored as: pi D F G / (4 n.v), all vectors of unit length.

    D is the GGX distribution of slopes of the width `alpha`, which a lamp's own width adds to;
    G is Smith's shadowing and masking, correlated in height.
    """
    half_vector = light_dir[:, None] + view_dir
    half_vector /= np.maximum(length(half_vector), np.float32(1e-12))
    alpha_squared = alpha * alpha
    distribution_denominator = dot(normal, half_vector) ** 2 * (alpha_squared - 1) + 1
    n_dot_v = np.maximum(dot(normal, view_dir), MIN_COSINE)
    n_dot_l = np.maximum(light_dir @ normal, 0)
    smith_denominator = n_dot_l * np.sqrt(n_dot_v**2 * (1 - alpha_squared) + alpha_squared)
    smith_denominator += n_dot_v * np.sqrt(n_dot_l**2 * (1 - alpha_squared) + alpha_squared)
    specular = (
        alpha_squared / distribution_denominator**2 * np.float32(0.5) / smith_denominator * n_dot_l
    )
    return specular * fresnel(f0, np.maximum(dot(half_vector, view_dir), 0))


def fresnel(f0: Color, cosine: Scalar) -> Color:
    """The share that is mirrored at this angle, `f0` being that straight on -- Schlick."""
    return f0 + (1 - f0) * (1 - cosine) ** 5


def sky_reflectance(f0: Color, roughness: Scalar, n_dot_v: Scalar) -> Color:
    """The share of an even sky that is mirrored; a rough surface shines less where it slants."""
    f90 = np.maximum(1 - roughness, f0)
    return f0 + (f90 - f0) * (1 - n_dot_v) ** 5


def dot(a: Color, b: Color) -> Scalar:
    return np.einsum("ij,ij->j", a, b)


def length(vectors: Color) -> Scalar:
    return np.sqrt(dot(vectors, vectors))
