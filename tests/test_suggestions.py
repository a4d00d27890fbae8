"""What a misspelled name may have meant."""

import pytest

from industnerf.config import flatten, read_yaml
from industnerf.suggestions import closest_names, did_you_mean
from tests.conftest import ROOT

KEYS = flatten(read_yaml(ROOT / "params.yaml"))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("views.cuont", "views.count"),  # letters exchanged
        ("viwes.count", "views.count"),
        ("view.count", "views.count"),  # a letter less
        ("count", "views.count"),  # the section left out
        ("retrieval.veiws", "method.retrieval.views"),
        ("Views.Count", "views.count"),
        ("split.devfraction", "split.dev_fraction"),
        ("method.industnerf.levles", "method.industnerf.levels"),
        ("held_out", "views.held_out"),
        ("sed", "seed"),
    ],
)
def test_the_closest_key_comes_first(name, expected):
    assert closest_names(name, KEYS)[0] == expected


def test_names_that_are_as_close_are_all_shown_up_to_three():
    assert did_you_mean("view", ["views", "rig"]) == ", did you mean `views`?"
    assert did_you_mean("noise", ["sweep-noise", "photo-noise"]).count("`") == 4
    assert len(closest_names("points", KEYS)) == 3


@pytest.mark.parametrize("name", ["foo", "x", "", "resolution_of_the_camera"])
def test_what_is_like_nothing_gets_no_advice(name):
    assert did_you_mean(name, KEYS) == ""
