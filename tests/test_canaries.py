"""The nets are tested too: a check that is switched off must not go unnoticed."""

import numpy as np
import pytest
from jaxtyping import TypeCheckError

from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.geometry.visibility import visible_from


def test_shape_annotations_are_enforced():
    with pytest.raises(TypeCheckError):
        visible_from(None, np.zeros((5, 2)), np.zeros((1, 3)), 0.1)


def test_types_are_enforced():
    with pytest.raises(TypeCheckError):
        fibonacci_sphere("seven")


def test_warnings_are_errors():
    with pytest.raises(RuntimeWarning):
        np.float64(1) / np.float64(0)
