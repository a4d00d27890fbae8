"""The comments of params.yaml, told apart by key."""

from pathlib import Path

from industnerf.config import flatten, read_yaml
from industnerf.report.docs.hyperparameters.yaml_comments import find_meaning, parse_comments

TEXT = """# What the file is.

seed: 0   # of everything
mode: a   # a: one way
          # b: another way
# which ones
methods: [x, y]

views:             # of a part
  count: 40        # at most, of
                   # each part
  color: "#fff"   # of it
  silent: 1
method:
  industnerf:
    levels:        # coarse to fine
      - steps: 3   # of training
        points: 5
      - steps: 4
        points: 6  # drawn
  nerf:
    levels:
      - steps: 7
"""


def test_each_key_has_its_own_comment():
    assert parse_comments(TEXT) == {
        "seed": "of everything",
        "mode": "a: one way; b: another way",
        "methods": "which ones",
        "views": "of a part",
        "views.count": "at most, of each part",
        "views.color": "of it",
        "views.silent": "",
        "method": "",
        "method.industnerf": "",
        "method.industnerf.levels": "coarse to fine",
        "method.industnerf.levels[0].steps": "of training",
        "method.industnerf.levels[0].points": "",
        "method.industnerf.levels[1].steps": "",
        "method.industnerf.levels[1].points": "drawn",
        "method.nerf": "",
        "method.nerf.levels": "",
        "method.nerf.levels[0].steps": "",
    }


def test_a_key_without_a_comment_means_what_its_twin_does():
    parsed = parse_comments(TEXT)
    assert find_meaning("method.industnerf.levels[1].steps", parsed) == "of training"
    assert find_meaning("method.nerf.levels[0].steps", parsed) == "of training"
    assert find_meaning("views.silent", parsed) == ""


def test_every_parameter_of_the_suite_is_explained(root: Path):
    """A new one needs a comment in params.yaml."""
    values = flatten(read_yaml(root / "params.yaml"), split_lists=True)
    parsed = parse_comments((root / "params.yaml").read_text())
    assert set(values) <= set(parsed)
    assert [key for key in values if not find_meaning(key, parsed)] == []
