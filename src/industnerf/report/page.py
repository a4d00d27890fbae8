"""One page that opens offline: everything it shows is inside it, and it may fetch nothing."""

from collections.abc import Sequence
from html import escape
from importlib.resources import files

from industnerf.report import table2, texts
from industnerf.report.comparisons import Comparison
from industnerf.report.exhibits import Exhibits
from industnerf.report.figures import calibration, distribution, failures, renderings
from industnerf.report.gather import Study
from industnerf.report.headline import by_part, table1, table2_html
from industnerf.report.lookup import Scores
from industnerf.report.markup import note, picture
from industnerf.report.part_pages import part_pages
from industnerf.report.strata import Stratum
from industnerf.report.tables import Extra, Row
from industnerf.report.verdicts import comparisons_html, strata_html
from industnerf.report.viewer import viewer

SCRIPTS = ("sort.js", "camera.js", "draw.js", "colours.js", "viewer.js")
# The browser itself refuses what would reach beyond the page.
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'"


def page(
    study: Study,
    rows: Sequence[Row],
    extras: Sequence[Extra],
    lines: Sequence[table2.Line],
    exhibits: Exhibits,
    interval: float,
    compared: Sequence[Comparison] = (),
    kinds: Sequence[Stratum] = (),
    protocols: str = "",
) -> str:
    """`report.html`; `interval` is what the tables' intervals cover, such as 0.95.

    `protocols` is the section of the grid of protocols, as HTML.
    """
    scores = Scores.of(study)
    shown = {scene.part.part_id for scene in exhibits.scenes}
    sections = {
        "Table 1": table1(study, scores, rows, extras, interval) + note(texts.TABLE1),
        "Truth and reconstruction": viewer(study, scores, exhibits.scenes),
        "Contact sheet": picture("jpeg", exhibits.sheet, "contact sheet", "sheet")
        + note(texts.SHEET),
        "Table 2": _table2(lines, interval),
        "Held-out views": renderings(exhibits.snapshots),
        "More than chance?": comparisons_html(compared, interval),
        "By kind of part": strata_html(kinds),
        "Every part against its floor": distribution(study, scores),
        "Is the confidence right?": calibration(study, scores),
        "Every protocol that the paper may have meant": protocols,
        "What it costs": note(texts.COST),
        "Part by part": f"<div id=parts>{note(texts.BY_PART)}{by_part(study, scores)}</div>",
        "Failures": failures(study),
    }
    body = "".join(f"<h2>{name}</h2>{text}" for name, text in sections.items() if text)
    return (
        "<!doctype html><html lang=en><meta charset=utf-8>"
        f'<meta http-equiv=Content-Security-Policy content="{POLICY}">'
        "<meta name=viewport content='width=device-width'>"
        f"<title>IndustNeRF: {escape(study.preset)}</title><style>{_web('page.css')}</style>"
        f"<h1>IndustNeRF suite: {escape(study.preset)}</h1>{_summary(study)}{body}"
        f"{part_pages(study, scores, shown)}"
        f"{''.join(f'<script>{_web(name)}</script>' for name in SCRIPTS)}</html>\n"
    )


def _web(name: str) -> str:
    return files("industnerf.report").joinpath("web", name).read_text()


def _summary(study: Study) -> str:
    tested = sum(place.split == "test" for place in study.places.values())
    families = len({part.family for part in study.parts.values()})
    return (
        f"<p>{len(study.parts)} parts of {families} families, {study.views} training views each, "
        f"reconstructed by {len(study.methods)} methods and scored by the exact Earth Mover's "
        f"Distance; {tested} parts are reported, {len(study.parts) - tested} are set apart for "
        "tuning (dev).</p>"
    )


def _table2(lines: Sequence[table2.Line], interval: float) -> str:
    if not lines:
        return note(table2.LEFT_OUT)
    return table2_html(lines, interval) + note(texts.TABLE2)
