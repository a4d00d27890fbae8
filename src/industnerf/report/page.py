"""One page that opens offline: everything it shows is inside it, and it may fetch nothing."""

import re
from collections.abc import Iterator, Sequence
from html import escape
from importlib.resources import files

from industnerf.report import table2, texts
from industnerf.report.comparisons import TESTED
from industnerf.report.exhibits import Exhibits
from industnerf.report.figures import calibration, distribution, failures, remarks, renderings
from industnerf.report.formats import brief
from industnerf.report.gather import Study
from industnerf.report.headline import by_part, table1, table2_html
from industnerf.report.lookup import Scores
from industnerf.report.markup import note, picture
from industnerf.report.part_pages import part_pages
from industnerf.report.results import Results
from industnerf.report.verdicts import (
    comparisons_html,
    goals_html,
    inspection_html,
    spending_html,
    strata_html,
)
from industnerf.report.viewer import viewer

SCRIPTS = ("sort.js", "camera.js", "draw.js", "colours.js", "viewer.js")
# The browser itself refuses what would reach beyond the page.
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"


def page(results: Results, exhibits: Exhibits, protocols: str = "", made: str = "") -> str:
    """`report.html`; `protocols` is the section of the grid of protocols, as HTML.

    `made` says when and where the report was made.
    """
    study, scores = results.study, Scores.of(results.study)
    shown = {scene.part.part_id for scene in exhibits.scenes}
    found = {name: text for name, text in _sections(results, scores, exhibits, protocols) if text}
    links = "".join(f"<a href='#{_anchor(name)}'>{name}</a>" for name in found)
    body = "".join(f"<h2 id='{_anchor(name)}'>{name}</h2>{text}" for name, text in found.items())
    return (
        "<!doctype html><html lang=en><meta charset=utf-8>"
        f'<meta http-equiv=Content-Security-Policy content="{POLICY}">'
        "<meta name=viewport content='width=device-width'>"
        f"<title>IndustNeRF: {escape(study.preset)}</title><style>{_web('page.css')}</style>"
        f"<h1>IndustNeRF suite: {escape(study.preset)}</h1>{_summary(study, made)}"
        f"{_headline(results)}<nav class=contents>{links}</nav>{body}"
        f"{part_pages(study, scores, shown, exhibits.album)}"
        f"{''.join(f'<script>{_web(name)}</script>' for name in SCRIPTS)}</html>\n"
    )


def _sections(
    results: Results, scores: Scores, exhibits: Exhibits, protocols: str
) -> Iterator[tuple[str, str]]:
    """Headings and what stands below them; empty where the study has nothing to say."""
    study, interval = results.study, results.interval
    yield "Table 1", table1(results.rows, results.extras, interval) + note(texts.TABLE1)
    yield "Truth and reconstruction", viewer(study, scores, exhibits.scenes)
    yield "Contact sheet", _sheet(exhibits)
    yield "Table 2", _table2(results.lines, interval)
    yield "Held-out views", renderings(exhibits.snapshots)
    yield "In millimetres", inspection_html(results.inspected)
    yield "More than chance?", comparisons_html(results.compared, interval)
    yield "By kind of part", strata_html(results.kinds)
    yield "Every part against its floor", distribution(study, scores)
    yield "Is the confidence right?", calibration(study, scores, exhibits.curves)
    yield "Every protocol that the paper may have meant", protocols
    yield "What it costs", _costs(results, exhibits)
    yield "What was to be reached", goals_html(results.reached)
    yield "Part by part", f"{note(texts.BY_PART)}{by_part(study, scores)}"
    yield "Failures", failures(study)
    yield "What methods remarked on the photographs", remarks(study)


def _anchor(name: str) -> str:
    """What a section is called within the page, such as `table-1`."""
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")


def _sheet(exhibits: Exhibits) -> str:
    if exhibits.sheet is None:
        return ""
    about = "contact sheet: a row a part, a column a method, coloured by the error"
    return picture("jpeg", exhibits.sheet, about, "sheet") + note(texts.SHEET)


def _costs(results: Results, exhibits: Exhibits) -> str:
    drawn = picture("png", exhibits.front, "EMD against seconds a part", "front")
    return drawn + note(texts.PARETO) + spending_html(results.spent)


def _web(name: str) -> str:
    return files("industnerf.report").joinpath("web", name).read_text(encoding="utf-8")


def _summary(study: Study, made: str) -> str:
    tested = sum(place.split == "test" for place in study.places.values())
    families = len({part.family for part in study.parts.values()})
    unscored = len(study.parts.keys() - {row.part_id for row in study.scores})
    missing = f" {unscored} have no score: see Failures." if unscored else ""
    return (
        f"<p>{len(study.parts)} parts of {families} families, {study.views} training views each, "
        f"reconstructed by {len(study.methods)} methods and scored by the exact Earth Mover's "
        f"Distance; {tested} parts are reported, {len(study.parts) - tested} are set apart for "
        f"tuning (dev).{missing} Seed {study.seed}.</p>"
        + (note(f"Made {escape(made)}.") if made else "")
    )


def _headline(results: Results) -> str:
    """The one sentence of a study that has the paper's method, or nothing."""
    rows = {row.method: row for row in results.rows if row.split == "test"}
    said = [
        f"<b>{method}</b> is at {row.emd_even:.4f} "
        f"({row.ratio_to_floor:.2f} floors, {brief(row.emd_mm)} mm)"
        for method in (*TESTED[::-1], "hull")
        if (row := rows.get(method))
    ]
    if not any(method in rows for method in TESTED):
        return ""
    return f"<p>Mean EMD in bounding-box diagonals, and in mm: {', '.join(said)}.</p>"


def _table2(lines: Sequence[table2.Line], interval: float) -> str:
    if not lines:
        return note(table2.LEFT_OUT)
    return table2_html(lines, interval) + note(texts.TABLE2)
