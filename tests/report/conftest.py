"""A small study, and its page."""

import pytest
from PIL import Image

from industnerf.report.exhibits import Exhibits
from industnerf.report.gather import Study
from industnerf.report.page import page
from industnerf.report.results import Results
from industnerf.report.scenes import scene
from industnerf.report.snapshots import Snapshots, jpeg
from industnerf.schema import ReportParams
from tests.report import gallery

SETTINGS = ReportParams(resamples=50, interval=0.9, sheet_parts=4)


@pytest.fixture(scope="session")
def study(tmp_path_factory) -> Study:
    """Two balls; see gallery.py."""
    folder = tmp_path_factory.mktemp("gallery")
    for name in gallery.PARTS:
        gallery.lay_out(folder, name)
    return gallery.study(folder)


@pytest.fixture(scope="session")
def report_page(study) -> str:
    """The page of `study`, both of whose parts are in the viewer."""
    grey = jpeg(Image.new("RGB", (8, 8), "grey"))
    taken = Snapshots(["hull"], [(study.parts["near-ball"], [[grey, None]])])
    scenes = [scene(study, part) for part in study.parts.values()]
    exhibits = Exhibits(grey, scenes, taken, b"", {"near-ball": [("photograph", grey)]})
    return page(Results.of(study, SETTINGS), exhibits, made="on a day")
