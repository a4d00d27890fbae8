"""A small study, and its page."""

from pathlib import Path

import pytest
from PIL import Image

from industnerf.report.figures.held_out_renderings import HeldOutRenderings, encode_jpeg
from industnerf.report.html.page import PageMedia, render_page
from industnerf.report.html.viewer import pack_scene
from industnerf.report.results import Results
from industnerf.report.study import Study
from industnerf.schema import ReportParams
from tests.report import ball_study
from tests.report.report_samples import publish_report

SETTINGS = ReportParams(bootstrap_resamples=50, confidence_level=0.9, contact_sheet_parts=4)


@pytest.fixture(scope="session")
def study(tmp_path_factory) -> Study:
    """Two balls; see ball_study.py."""
    folder = tmp_path_factory.mktemp("gallery")
    for name in ball_study.PARTS:
        ball_study.write_part(folder, name)
    return ball_study.study(folder)


@pytest.fixture(scope="session")
def report_page(study) -> str:
    """The page of `study`, both of whose parts are in the viewer."""
    gray = encode_jpeg(Image.new("RGB", (8, 8), "gray"))
    renderings = HeldOutRenderings(["hull"], [(study.parts["near-ball"], [[gray, None]])])
    scenes = [pack_scene(study, part) for part in study.parts.values()]
    media = PageMedia(gray, scenes, renderings, b"", {"near-ball": [("image", gray)]})
    return render_page(Results.from_study(study, SETTINGS), media, provenance="on a day")


@pytest.fixture
def published(tmp_path) -> Path:
    """The published results of `small_study`."""
    return publish_report(tmp_path)
