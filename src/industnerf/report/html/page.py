"""`report.html`: one page that holds all that it shows, opens offline, and fetches nothing."""

import base64
import io
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any
from urllib.parse import quote

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from PIL import Image

from industnerf.artifacts.part import Part
from industnerf.report.figures.held_out_renderings import (
    HeldOutRenderings,
    PartImages,
    encode_jpeg,
    load_held_out_renderings,
    load_part_images,
)
from industnerf.report.figures.strip_plots import calibration_plots, distribution_plot
from industnerf.report.html.part_sections import part_sections
from industnerf.report.html.tables import page_tables, trained_methods
from industnerf.report.html.viewer import ViewerScene, pack_scene, viewer_context
from industnerf.report.results import Results
from industnerf.report.statistics.comparisons import TESTED_METHODS
from industnerf.report.study import Study
from industnerf.report.tables.formats import format_significant
from industnerf.report.tables.protocol_grid import PublishedGrid
from industnerf.report.tables.scores import Scores
from industnerf.report.tables.table1 import Table1Row
from industnerf.report.tables.table1_format import table1_notes
from industnerf.report.tables.table2 import NO_TABLE2

SHEET_PX = 2200  # of the contact sheet on the page; the file beside it is larger
SCRIPTS = ("sort.js", "camera.js", "draw.js", "colors.js", "viewer.js")
# The browser itself refuses what would reach beyond the page.
CONTENT_SECURITY_POLICY = (
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
)


@dataclass(frozen=True)
class PageMedia:
    """The images and clouds of the page."""

    contact_sheet: bytes | None  # JPEG; None without a part to show
    viewer_scenes: Sequence[ViewerScene]
    held_out_renderings: HeldOutRenderings
    pareto_plot: bytes  # PNG: EMD against seconds
    part_images: PartImages = field(default_factory=dict)
    sparsification_plot: bytes | None = None  # PNG; None if no method states a confidence


def load_page_media(
    study: Study,
    parts: list[Part],
    contact_sheet: bytes | None,
    pareto_plot: bytes,
    sparsification_plot: bytes | None,
) -> PageMedia:
    """The media of a page that shows `parts` in its viewer; the three images are PNG.

    Raises BadArtifact if a file is torn.
    """
    return PageMedia(
        encode_jpeg(Image.open(io.BytesIO(contact_sheet)), SHEET_PX) if contact_sheet else None,
        [pack_scene(study, part) for part in parts],
        load_held_out_renderings(study, parts),
        pareto_plot,
        load_part_images(study),
        sparsification_plot,
    )


def render_page(
    results: Results, media: PageMedia, grid: PublishedGrid | None = None, provenance: str = ""
) -> str:
    """The text of `report.html`; `provenance` says when and where the report was made."""
    study, scores = results.study, Scores.from_study(results.study)
    assignments = study.assignments.values()
    return (
        environment()
        .get_template("page.html.j2")
        .render(
            study=study,
            media=media,
            grid=grid,
            provenance=provenance,
            tables=page_tables(results, scores, grid),
            trained=trained_methods(results.table1),
            table1_notes=table1_notes(results.table1),
            no_table2=NO_TABLE2,
            headline=_headline(results),
            distribution=distribution_plot(study, scores),
            calibration=calibration_plots(study, scores),
            viewer=viewer_context(study, scores, media.viewer_scenes),
            part_sections=part_sections(
                study,
                scores,
                {scene.part.part_id for scene in media.viewer_scenes},
                media.part_images,
            ),
            failures=_messages(study, study.failures),
            warnings=_messages(
                study,
                {
                    method: {part: "; ".join(texts) for part, texts in warnings.items()}
                    for method, warnings in study.input_warnings.items()
                },
            ),
            num_families=len({part.family for part in study.parts.values()}),
            num_test=sum(assignment.split == "test" for assignment in assignments),
            num_unscored=len(study.parts.keys() - {row.part_id for row in study.scores}),
            scripts=SCRIPTS,
            content_security_policy=CONTENT_SECURITY_POLICY,
        )
    )


@cache
def environment() -> Environment:
    """The templates of the page; what they are given is escaped, and a missing name raises."""
    env = Environment(
        loader=PackageLoader("industnerf.report.html"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    env.policies["json.dumps_kwargs"] = {"allow_nan": False, "separators": (",", ":")}
    env.globals |= {"zip": zip, "web_file": _web_file}
    env.filters |= {
        "anchor": _anchor,
        "base64": lambda content: base64.b64encode(content).decode(),
        "part_anchor": _part_anchor,
        "part_href": _part_href,
        "significant": format_significant,
    }
    return env


def _web_file(name: str) -> Markup:
    """A script or style sheet of our own, which is not escaped."""
    return Markup(files("industnerf.report.html").joinpath("web", name).read_text(encoding="utf-8"))


def _anchor(title: str) -> str:
    """The id of a section, such as `table-1`."""
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")


def _part_anchor(part_id: str) -> str:
    """The id of the section of a part."""
    return f"part={part_id}"


def _part_href(part_id: str) -> str:
    """A link to the section of a part."""
    return "#" + quote(_part_anchor(part_id), safe="=")


def _headline(results: Results) -> list[Table1Row]:
    """The rows of Table 1 that the page starts with; none without a method of ours."""
    rows = {row.method: row for row in results.table1 if row.split == "test"}
    if not any(method in rows for method in TESTED_METHODS):
        return []
    return [rows[method] for method in (*TESTED_METHODS[::-1], "hull") if method in rows]


def _messages(study: Study, messages: dict[str, dict[str, str]]) -> list[tuple[Any, ...]]:
    """Who said what of which part, and whether that part has a section to link to."""
    return [
        (source, part_id, part_id in study.parts, text)
        for source, parts in messages.items()
        for part_id, text in parts.items()
    ]
