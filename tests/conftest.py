"""What all tests share."""

from pathlib import Path

import pytest
from hypothesis import settings
from jaxtyping import install_import_hook

# Shapes are checked in every call.  `industnerf` itself is loaded before numpy (pyproject.toml).
install_import_hook("industnerf", "beartype.beartype")

ROOT = Path(__file__).parents[1]

# The same examples in every run; no deadline, for the machine may be shared.
settings.register_profile("suite", derandomize=True, deadline=None, max_examples=40)
settings.load_profile("suite")


@pytest.fixture
def root() -> Path:
    """The root of the repository."""
    return ROOT
