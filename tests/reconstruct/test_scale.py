"""A known distance makes millimeters of any unit."""

import numpy as np
import pytest

from industnerf.errors import BadArtifact
from industnerf.reconstruct.load_images import load_images
from industnerf.reconstruct.scale import Scale
from industnerf.reconstruct.sources import Selection
from tests.reconstruct import sample_images

CENTERS = sample_images.cameras().centers
BASELINE = float(np.linalg.norm(CENTERS[0] - CENTERS[3]))


@pytest.fixture
def path(tmp_path):
    return sample_images.write_image_set(tmp_path)


def load(path, *ends, distance=25.0, **options):
    selection = Selection(scale=Scale(ends, distance))
    return load_images(path, None, max_size=512, selection=selection, **options)


@pytest.mark.parametrize(
    ("ends", "factor"),
    [
        (("1,2,3", "1,2,-2.0e0"), 25 / 5),
        (("-1, 0, 0", ".5,0,2"), 25 / 2.5),
        (("rgb/000.png", "rgb/003.png"), 25 / BASELINE),
        (("000.PNG", "./rgb/003.png"), 25 / BASELINE),
        ((",".join(map(str, CENTERS[0])), "003.png"), 25 / BASELINE),
    ],
)
def test_points_and_cameras_may_be_named(path, ends, factor):
    image_set = load(path, *ends)
    np.testing.assert_allclose(image_set.cameras.centers, factor * CENTERS, rtol=1e-9)
    np.testing.assert_allclose(image_set.center, factor * sample_images.CENTER, rtol=1e-9)
    assert any("so that --scale's distance is in mm" in text for text in image_set.warnings)


def test_the_region_is_in_millimeters_too(path):
    image_set = load(path, "0,0,0", "0,0,1", center=(250.0, -100.0, 75.0), radius=30.0)
    assert (image_set.center.tolist(), image_set.radius) == ([250, -100, 75], 30)


@pytest.mark.parametrize(
    ("ends", "complaint"),
    [
        (("1,2,3", "1,2,3"), "both ends are one point"),
        (("1,2", "1,2,3"), "1,2: is neither a point x,y,z nor the name of one photograph"),
        (("nan,2,3", "1,2,3"), "neither a point"),
        (("rgb/009.png", "1,2,3"), "neither a point"),
    ],
)
def test_an_end_that_is_none_is_refused(path, ends, complaint):
    with pytest.raises(BadArtifact, match=complaint):
        load(path, *ends)
