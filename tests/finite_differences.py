"""Finite differences, for what is computed in float32."""

from collections.abc import Callable

from torch import Tensor


def directional_derivative(
    loss: Callable[[Tensor], Tensor], point: Tensor, direction: Tensor, h: float
) -> Tensor:
    """Of `loss` at a place along a way, from the five points that are h apart.

    Its error is h^4 / 30 of the fifth derivative, and 3 / (2 h) of a rounding of the loss.
    """
    one, two = (loss(point + n * h * direction) - loss(point - n * h * direction) for n in (1, 2))
    return (8 * one - two) / (12 * h)
