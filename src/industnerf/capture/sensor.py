"""From radiance to a file's pixels, in the order of a camera: lens, sensor, 8 bits, compression.

Radiance beyond white spreads in the lens before the sensor cuts it off.
"""

import io
from collections.abc import Iterable

import numpy as np
from jaxtyping import Float32, UInt8
from PIL import Image
from scipy.ndimage import gaussian_filter

from industnerf.schema import SensorParams

Plane = Float32[np.ndarray, "h w"]  # of one color; white is 255


def simulate_sensor(
    planes: Iterable[Plane], sensor: SensorParams, rng: np.random.Generator
) -> UInt8[np.ndarray, "h w 3"]:
    """The 8-bit image of the radiance in `planes`: red, green and blue."""
    channels = []
    for plane in planes:
        if sensor.blur_px:
            plane = blur(plane, sensor.blur_px)
        if sensor.noise:
            plane = add_noise(plane, sensor.noise, rng)
        channels.append(quantize(plane))
    rgb = np.stack(channels, axis=-1)
    return jpeg_roundtrip(rgb, sensor.jpeg_quality) if sensor.jpeg_quality else rgb


def blur(plane: Plane, sigma_px: float) -> Plane:
    """`plane` under a Gaussian; it is mirrored at its border, so the mean stays."""
    return gaussian_filter(plane, sigma_px, mode="reflect")


def add_noise(plane: Plane, sigma: float, rng: np.random.Generator) -> Plane:
    """`plane` and Gaussian noise, independent in every pixel; `sigma` counts in white."""
    return plane + np.float32(255 * sigma) * rng.standard_normal(plane.shape, np.float32)


def quantize(plane: Plane) -> UInt8[np.ndarray, "h w"]:
    """Rounded, and cut off at black and white."""
    return (np.clip(plane, 0, 255) + np.float32(0.5)).astype(np.uint8)  # the cast rounds down


def jpeg_roundtrip(rgb: UInt8[np.ndarray, "h w 3"], quality: int) -> UInt8[np.ndarray, "h w 3"]:
    """What is left of `rgb` in a JPEG file, color at half the resolution as cameras do."""
    file = io.BytesIO()
    Image.fromarray(rgb).save(file, "JPEG", quality=quality, subsampling="4:2:0")
    with Image.open(file) as image:
        return np.asarray(image)
