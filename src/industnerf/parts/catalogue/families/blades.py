"""Sections of blades, for whatever turns in a fluid."""

import math

from build123d import Plane, Sketch

from industnerf.parts.catalogue.families.drawing import Point, Real, polygon


def airfoil(chord: Real, thickness: Real, camber: Real) -> list[Point]:
    """Outline of a NACA 4-digit section about its half-chord point, trailing edge first.

    `thickness` and `camber` are shares of the chord; the trailing edge is 1 % thick.
    """
    stations = [0.5 * (1 - math.cos(math.pi * i / 12)) for i in range(13)]

    def half(x: Real) -> float:
        root = 0.2969 * math.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1015 * x**4
        return 5 * thickness * root + 0.005 * x

    line = [4 * camber * x * (1 - x) for x in stations]
    upper = [(x, y + half(x)) for x, y in zip(stations, line, strict=True)]
    lower = [(x, y - half(x)) for x, y in zip(stations, line, strict=True)]
    return [((x - 0.5) * chord, y * chord) for x, y in [*reversed(upper), *lower[1:]]]


def airfoil_face(chord: Real, thickness: Real, camber: Real) -> Sketch:
    """The section as 25 straight sides, which keep within the tolerance of the parts' meshes.

    A loft of splines takes 10 to 30 times the triangles, and OpenCASCADE states its volume wrong.
    """
    return polygon(airfoil(chord, thickness, camber))


def blade_section(
    radius: Real, pitch_angle: Real, chord: Real, thickness: Real, camber: Real
) -> Sketch:
    """An airfoil across the x axis at `radius`, turned by `pitch_angle` out of the xy plane."""
    a = math.radians(pitch_angle)
    plane = Plane((radius, 0, 0), x_dir=(0, math.cos(a), math.sin(a)), z_dir=(1, 0, 0))
    return plane * airfoil_face(chord, thickness, camber)
