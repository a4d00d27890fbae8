"""How large the page is: all of it is read before it can be used, so this is how fast it opens.

It grows with the parts by what their numbers take, and with those in the viewer by their clouds.
"""

import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from industnerf.report.figures.held_out_renderings import MAX_SIDE_PX, encode_jpeg
from industnerf.report.html.page import CONTENT_SECURITY_POLICY
from industnerf.report.html.part_sections import part_sections
from industnerf.report.html.viewer import SHOWN_POINTS, pack_scene
from industnerf.report.study import Study
from industnerf.report.tables.scores import Scores
from tests.report import ball_study
from tests.report.html.test_page import bare_page

BASE64 = 4 / 3
POINT = 6 + 1 + 1 + 1 + 2 + 3  # bytes: positions, error, missed, confidence, view, color
NAMED = 400  # bytes of names and numbers round the arrays of a cloud
# Bytes on the page.  A score is a cell, `<td>0.2000 (failed)`, in its part's table, and some are
# a dot in a plot too, which has a link and a name: 220.  A method has a row in each table, its
# name in two tables, and its failure.  A part has a heading, links to its neighbors, and facts.
SCORE, METHOD, PART = 100, 400, 1000
FIXED = 60_000  # scripts and style are 24 kB, what is said of each section is less


def with_parts(study: Study, count: int) -> Study:
    """`study` with so many parts, that have what its first one has."""
    names = [f"part-{i:04}" for i in range(count)]
    return replace(
        study,
        parts={name: ball_study.part(name) for name in names},
        assignments=dict.fromkeys(names, study.assignments["near-ball"]),
        scores=[score for name in names for score in ball_study.scores(name)],
        failures={"box": dict.fromkeys(names, ball_study.FAILURE)},
        train_visible_share=dict.fromkeys(names, 0.9),
        rig_visible_share=dict.fromkeys(names, 1.0),
    )


def test_a_part_adds_its_own_numbers_and_nothing_to_those_of_others(study):
    """The same for each, apart from the digits in which coordinates of the plots are written."""
    few, more, many = (len(bare_page(with_parts(study, count))) for count in (10, 50, 210))
    bytes_a_part = (more - few) / 40
    assert (many - more) / 160 == pytest.approx(bytes_a_part, rel=1e-3)
    scores, methods = len(ball_study.scores("a")), len(ball_study.EMD)
    assert bytes_a_part < SCORE * scores + METHOD * methods + PART


class CountedScores(dict):
    """Scores by key that know how often all of them were gone through."""

    passes = 0

    def items(self):
        self.passes += 1
        return super().items()


def test_a_part_goes_through_its_own_scores_and_not_through_those_of_all(study):
    """Else twice the parts take four times as long: at 10 000 minutes."""
    many = with_parts(study, 40)
    scores = Scores(CountedScores(Scores.from_study(many).by_key))
    assert len(part_sections(many, scores, set(), {})) == 40
    assert scores.by_key.passes <= 1


def test_a_cloud_in_the_viewer_takes_at_most_fourteen_bytes_a_point_however_many_it_has(tmp_path):
    ball_study.write_part(tmp_path, "near-ball", 2 * SHOWN_POINTS)
    dense = ball_study.study(tmp_path)
    clouds = pack_scene(dense, dense.parts["near-ball"]).clouds
    assert set(clouds["hull"]["arrays"]) > {"missed", "confidence", "view", "color"}  # all of them
    for cloud in clouds.values():
        assert len(str(cloud)) < BASE64 * POINT * SHOWN_POINTS + NAMED


def test_a_picture_is_small_even_of_noise():
    """A byte a pixel, where nothing can be left out."""
    noise = np.random.default_rng(0).integers(0, 256, (MAX_SIDE_PX, MAX_SIDE_PX, 3), np.uint8)
    assert len(encode_jpeg(Image.fromarray(noise))) < MAX_SIDE_PX**2


def test_the_whole_page_is_the_sum_of_these(study, report_page):
    """Both parts are in the viewer, with the truth, two clouds of 2000 points, and no box."""
    assert len(bare_page(with_parts(study, 0))) < FIXED
    scores, methods = len(ball_study.scores("a")), len(ball_study.EMD)
    numbers = len(study.parts) * (SCORE * scores + METHOD * methods + PART)
    clouds = len(study.parts) * (methods + 1) * (BASE64 * POINT * 2000 + NAMED)
    pictures = report_page.count("data:image") * BASE64 * MAX_SIDE_PX**2
    assert len(report_page) < FIXED + numbers + clouds + pictures


def test_no_address_of_another_place_is_on_the_page(report_page):
    """Nor could it be asked for: the policy lets the browser fetch nothing."""
    assert re.findall(r"\w*://|@import|url\((?!data:)|\bfetch\(|XMLHttpRequest", report_page) == []
    assert "default-src 'none'" in CONTENT_SECURITY_POLICY
    assert f'content="{CONTENT_SECURITY_POLICY}"' in report_page
