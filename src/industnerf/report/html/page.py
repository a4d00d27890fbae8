"""One page that opens offline: everything it shows is inside it, and it may fetch nothing."""

import re
from collections.abc import Iterator, Sequence
from html import escape
from importlib.resources import files

from industnerf.report.html import captions
from industnerf.report.html.figure_sections import (
    calibration_html,
    distribution_html,
    failures_html,
    renderings_html,
    warnings_html,
)
from industnerf.report.html.main_tables import part_table_html, table1_html, table2_html
from industnerf.report.html.markup import image_html, note
from industnerf.report.html.page_media import PageMedia
from industnerf.report.html.part_sections import part_sections
from industnerf.report.html.summary_tables import (
    comparisons_html,
    cost_table_html,
    goals_html,
    inspection_html,
    strata_html,
)
from industnerf.report.html.viewer import viewer_html
from industnerf.report.results import Results
from industnerf.report.statistics.comparisons import TESTED_METHODS
from industnerf.report.study import Study
from industnerf.report.tables import table2
from industnerf.report.tables.formats import format_significant
from industnerf.report.tables.score_lookup import Scores

SCRIPTS = ("sort.js", "camera.js", "draw.js", "colors.js", "viewer.js")
# The browser itself refuses what would reach beyond the page.
CONTENT_SECURITY_POLICY = (
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"
)


def render_page(
    results: Results, media: PageMedia, protocol_grid: str = "", provenance: str = ""
) -> str:
    """`report.html`; `protocols` is the section of the grid of protocols, as HTML.

    `made` says when and where the report was made.
    """
    study, scores = results.study, Scores.from_study(results.study)
    viewer_part_ids = {scene.part.part_id for scene in media.viewer_scenes}
    sections = {
        name: text for name, text in _sections(results, scores, media, protocol_grid) if text
    }
    links = "".join(f"<a href='#{_anchor(name)}'>{name}</a>" for name in sections)
    body = "".join(f"<h2 id='{_anchor(name)}'>{name}</h2>{text}" for name, text in sections.items())
    return (
        "<!doctype html><html lang=en><meta charset=utf-8>"
        f'<meta http-equiv=Content-Security-Policy content="{CONTENT_SECURITY_POLICY}">'
        "<meta name=viewport content='width=device-width'>"
        f"<title>IndustNeRF: {escape(study.preset)}</title><style>{_web_file('page.css')}</style>"
        f"<h1>IndustNeRF suite: {escape(study.preset)}</h1>{_summary(study, provenance)}"
        f"{_headline(results)}<nav class=contents>{links}</nav>{body}"
        f"{part_sections(study, scores, viewer_part_ids, media.part_images)}"
        f"{''.join(f'<script>{_web_file(name)}</script>' for name in SCRIPTS)}</html>\n"
    )


def _sections(
    results: Results, scores: Scores, media: PageMedia, protocol_grid: str
) -> Iterator[tuple[str, str]]:
    """Headings and what stands below them; empty where the study has nothing to say."""
    study, interval = results.study, results.interval
    yield (
        "Table 1",
        table1_html(results.table1, results.table1_extras, interval) + note(captions.TABLE1),
    )
    yield "Truth and reconstruction", viewer_html(study, scores, media.viewer_scenes)
    yield "Contact sheet", _contact_sheet(media)
    yield "Table 2", _table2(results.table2, interval)
    yield "Held-out views", renderings_html(media.held_out_renderings)
    yield "In millimeters", inspection_html(results.inspection)
    yield "More than chance?", comparisons_html(results.comparisons, interval)
    yield "By kind of part", strata_html(results.strata)
    yield "Every part against its floor", distribution_html(study, scores)
    yield "Is the confidence right?", calibration_html(study, scores, media.sparsification_plot)
    yield "Every protocol that the paper may have meant", protocol_grid
    yield "What it costs", _costs(results, media)
    yield "What was to be reached", goals_html(results.goals)
    yield "Part by part", f"{note(captions.BY_PART)}{part_table_html(study, scores)}"
    yield "Failures", failures_html(study)
    yield "What methods remarked on the photographs", warnings_html(study)


def _anchor(name: str) -> str:
    """What a section is called within the page, such as `table-1`."""
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def _contact_sheet(media: PageMedia) -> str:
    if media.contact_sheet is None:
        return ""
    alt_text = "contact sheet: a row a part, a column a method, colored by the error"
    return image_html("jpeg", media.contact_sheet, alt_text, "sheet") + note(captions.SHEET)


def _costs(results: Results, media: PageMedia) -> str:
    pareto_image = image_html("png", media.pareto_plot, "EMD against seconds a part", "front")
    return pareto_image + note(captions.PARETO) + cost_table_html(results.costs)


def _web_file(name: str) -> str:
    return files("industnerf.report.html").joinpath("web", name).read_text(encoding="utf-8")


def _summary(study: Study, provenance: str) -> str:
    num_test = sum(assignment.split == "test" for assignment in study.assignments.values())
    families = len({part.family for part in study.parts.values()})
    unscored = len(study.parts.keys() - {row.part_id for row in study.scores})
    missing = f" {unscored} have no score: see Failures." if unscored else ""
    return (
        f"<p>{len(study.parts)} parts of {families} families, {study.num_train_views} training views each, "
        f"reconstructed by {len(study.methods)} methods and scored by the exact Earth Mover's "
        f"Distance; {num_test} parts are reported, {len(study.parts) - num_test} are set apart for "
        f"tuning (dev).{missing} Seed {study.seed}.</p>"
        + (note(f"Made {escape(provenance)}.") if provenance else "")
    )


def _headline(results: Results) -> str:
    """The one sentence of a study that has the paper's method, or nothing."""
    rows = {row.method: row for row in results.table1 if row.split == "test"}
    sentences = [
        f"<b>{method}</b> is at {row.emd_even:.4f} "
        f"({row.ratio_to_floor:.2f} floors, {format_significant(row.emd_mm)} mm)"
        for method in (*TESTED_METHODS[::-1], "hull")
        if (row := rows.get(method))
    ]
    if not any(method in rows for method in TESTED_METHODS):
        return ""
    return f"<p>Mean EMD in bounding-box diagonals, and in mm: {', '.join(sentences)}.</p>"


def _table2(rows: Sequence[table2.Table2Row], interval: float) -> str:
    if not rows:
        return note(table2.NO_TABLE2)
    return table2_html(rows, interval) + note(captions.TABLE2)
