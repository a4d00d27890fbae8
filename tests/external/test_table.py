"""What is said of clouds from outside, on scores that are given."""

from industnerf.artifacts.scores import PartScore, Score
from industnerf.external.table import (
    OUTSIDE_STUDY,
    PublishedScores,
    load_published_scores,
    part_rows,
    summary,
)
from industnerf.schema import ReportParams
from tests.conftest import ROOT
from tests.samples import unit_part

CONFIG = ReportParams(bootstrap_resamples=200, confidence_level=0.9, contact_sheet_parts=4)


def scores_of(part_id: str, emd: float, status: str = "ok") -> list[PartScore]:
    kinds = {
        ("emd", "P1-even"): (emd, 0.01, "diagonal"),
        ("hausdorff95", "P1-dense"): (1.5, 0.5, "mm"),
        ("within_0.5mm", "P1-dense"): (0.25, 1.0, "share"),
    }
    return [
        PartScore(part_id, "mine", Score(*kind, value, floor, unit, status))
        for kind, (value, floor, unit) in kinds.items()
    ]


def test_a_line_says_what_the_part_scored_also_in_mm():
    part = unit_part("a", extents_mm=(0.0, 0.0, 50.0))
    (line,) = part_rows(scores_of("a", 0.02), {"a": part})
    assert line == ["a", "0.0200", "2.00", "1.00", "1.50", "25 %"]
    (line,) = part_rows(scores_of("a", 0.02, "failed"), {"a": part})
    assert line[0].endswith("\nfailed")


def test_test_parts_dev_parts_and_others_are_told_apart_and_compared_on_the_same_parts():
    emds = {"a": 0.02, "b": 0.04, "c": 0.1, "d": 0.3}
    parts = {name: unit_part(name, family=f"of {name}") for name in emds}
    scores = [row for name, emd in emds.items() for row in scores_of(name, emd)]
    published = PublishedScores(
        {"a": "test", "b": "test", "z": "test", "c": "dev"},
        {"hull": {"a": 0.03, "b": 0.03, "z": 0.9, "c": 0.05}},
    )
    tested, dev, others = summary(scores, parts, published, CONFIG, seed=0)
    assert "test: 2 of 3 parts of 2 families, 0 failed" in tested
    assert "EMD (even) 0.0300 (0.0200 to 0.0400), 3.00 x floor" in tested
    assert "hull 0.0300 on these: +0.0000 (-0.0100 to +0.0100), lower on 1 of 2" in tested
    assert "dev: 1 of 1 parts" in dev
    assert "hull 0.0500 on these: +0.0500" in dev
    assert f"{OUTSIDE_STUDY}: 1 parts" in others
    assert "hull" not in others


def test_of_one_family_there_is_no_interval():
    """Two parts of a family: EMD 0.02 and 0.04, hull 0.03 on both and 0.0 in the mean change."""
    parts = {name: unit_part(name, family="nuts") for name in "ab"}
    scores = [*scores_of("a", 0.02), *scores_of("b", 0.04)]
    published = PublishedScores({"a": "test", "b": "test"}, {"hull": {"a": 0.03, "b": 0.03}})
    for subset, mean, change in ((scores, "0.0300", "+0.0000"), (scores[:3], "0.0200", "-0.0100")):
        (text,) = summary(subset, parts, published, CONFIG, seed=0)
        assert f"EMD (even) {mean}, " in text
        assert f"hull 0.0300 on these: {change}, lower on 1 of" in text
        assert " to " not in text


def test_failures_are_counted():
    parts = {"a": unit_part("a")}
    (text,) = summary(scores_of("a", 0.5, "failed"), parts, PublishedScores({}, {}), CONFIG, seed=0)
    assert "1 failed" in text


def test_the_published_study_is_read_as_it_is():
    published = load_published_scores(ROOT / "results/study")
    assert published.values["hull"].keys() == published.splits.keys()
    assert min(published.values["industnerf_plus"].values()) > 0
