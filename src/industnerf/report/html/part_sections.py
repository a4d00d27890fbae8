"""A section of the page for every part: what it is, and all its scores."""

from html import escape

from industnerf.artifacts.part import Part
from industnerf.artifacts.scores import Score
from industnerf.report.figures.held_out_renderings import PartImages
from industnerf.report.figures.sparsification import ERROR_LEFT_PREFIX
from industnerf.report.html.main_tables import format_percent
from industnerf.report.html.markup import (
    Column,
    HtmlRow,
    html_table,
    image_html,
    note,
    part_anchor,
    part_link,
)
from industnerf.report.study import Study
from industnerf.report.tables.formats import format_fixed, format_significant
from industnerf.report.tables.score_lookup import EMD_EVEN, Scores
from industnerf.report.tables.table2 import LOSSES

METRIC_NAMES = {  # as people say them; what is not here keeps the name it has in scores.csv
    EMD_EVEN: "EMD (even)",
    ("emd", "P1-iid"): "EMD (iid)",
    ("emd", "P1-full"): "EMD (full)",
    ("chamfer", "P1-dense"): "Chamfer",
    ("fscore", "P1-dense"): "F-score",
    ("within_0.1mm", "P1-dense"): "cloud within 0.1 mm",
    ("within_0.5mm", "P1-dense"): "cloud within 0.5 mm",
    ("within_1mm", "P1-dense"): "cloud within 1 mm",
    ("covered_0.1mm", "P1-dense"): "surface within 0.1 mm",
    ("covered_0.5mm", "P1-dense"): "surface within 0.5 mm",
    ("covered_1mm", "P1-dense"): "surface within 1 mm",
    ("hausdorff95", "P1-dense"): "Hausdorff-95",
} | {(loss.metric, loss.protocol): loss.name for loss in LOSSES if loss.metric != "emd"}
IMAGE_AND_CONFIDENCE_PROTOCOLS = (
    "P1-union",
    "P1-frame",
    "P1-near",
)  # protocols of renderings and of confidence
UNSTATED_UNITS = ("1", "diagonal")  # units that go without saying
FOUR_DECIMAL_UNITS = ("1", "diagonal", "share")  # the others range over many magnitudes


def part_sections(
    study: Study, scores: Scores, in_viewer: set[str], part_images: PartImages
) -> str:
    """All sections, in the order of their table; each shows when the page is opened at it."""
    parts = sorted(study.parts.values(), key=lambda part: (part.family, part.part_id))
    neighborhoods = zip([None, *parts], parts, [*parts[1:], None], strict=False)
    return "".join(
        f"<section class=part id='{escape(part_anchor(part.part_id))}'>"
        f"<h2>{escape(part.designation)}</h2>"
        f"<nav>{_navigation(part, before, after, in_viewer)}</nav>"
        f"{_image_row(part_images.get(part.part_id, []))}{_section(study, scores, part)}</section>"
        for before, part, after in neighborhoods
    )


def _navigation(part: Part, before: Part | None, after: Part | None, in_viewer: set[str]) -> str:
    """Links to where one may want to go from here."""
    links = ["<a href='#part-by-part'>all parts</a>"]
    links += [part_link(other.part_id, other.designation) for other in (before, after) if other]
    if part.part_id in in_viewer:
        links.append(
            f"<a href='#viewer' data-scene='{escape(part.part_id)}'>show it in the viewer</a>"
        )
    return "".join(links)


def _image_row(images: list[tuple[str, bytes]]) -> str:
    """One view, photographed and rendered; empty if nobody photographed it."""
    figures = "".join(
        f"<figure>{image_html('jpeg', content, name)}<figcaption>{escape(name)}</figcaption></figure>"
        for name, content in images
    )
    return figures and f"<div class=album>{figures}</div>"


def _section(study: Study, scores: Scores, part: Part) -> str:
    units_by_metric_key = dict(
        sorted(
            scores.units_by_metric_key().items(), key=lambda metric_key: metric_key[0][0] != "emd"
        )
    )
    surface_metrics = {
        metric_key: unit
        for metric_key, unit in units_by_metric_key.items()
        if metric_key[1] not in IMAGE_AND_CONFIDENCE_PROTOCOLS
    }
    image_metrics = {  # but for the points of a curve, whose area stands there
        metric_key: unit
        for metric_key, unit in units_by_metric_key.items()
        if metric_key[1] in IMAGE_AND_CONFIDENCE_PROTOCOLS
        and not metric_key[0].startswith(ERROR_LEFT_PREFIX)
    }
    return (
        f"{_facts(study, part)}{_scores(study, scores, part, surface_metrics)}"
        f"{_scores(study, scores, part, image_metrics)}{_failures(study, part)}{_input_warnings(study, part)}"
    )


def _facts(study: Study, part: Part) -> str:
    assignment = study.assignments[part.part_id]
    size = " x ".join(format_significant(edge) for edge in part.extents_mm)
    facts = {
        "id": part.part_id,
        "family": part.family,
        "split": assignment.split
        + ("" if assignment.fold is None else f", fold {assignment.fold}"),
        "size": f"{size} mm, diagonal {format_significant(part.diagonal_mm)} mm",
        "strata": ", ".join(part.strata),
        "surface": f"{part.area_mm2:.0f} mm\u00b2, {format_percent(part.visible_share)} visible",
        "seen by training views": format_percent(study.train_visible_share.get(part.part_id)),
        "bodies": str(part.bodies),
        "defects": "; ".join(part.defects),
    }
    rows = "".join(f"<dt>{name}<dd>{escape(text)}" for name, text in facts.items() if text)
    return f"<dl class=facts>{rows}</dl>"


def _scores(
    study: Study, scores: Scores, part: Part, units_by_metric_key: dict[tuple[str, str], str]
) -> str:
    """One row a method; empty where no method has a score of one of `kinds`."""
    columns, rows = [Column("method", True)], []
    for metric_key, unit in units_by_metric_key.items():
        columns += _columns(metric_key, unit)
    for method in study.methods:
        method_scores = {
            metric_key: scores.get(part.part_id, method, metric_key)
            for metric_key in units_by_metric_key
        }
        texts = [
            text
            for metric_key in units_by_metric_key
            for text in _score_cells(
                method_scores[metric_key], metric_key, units_by_metric_key[metric_key], part
            )
        ]
        failed = any(score and score.status != "ok" for score in method_scores.values())
        if any(texts):
            rows.append(HtmlRow([escape(method), *texts], "failed" if failed else ""))
    return html_table(columns, rows) if rows else ""


def _columns(metric_key: tuple[str, str], unit: str) -> list[Column]:
    name = _name(metric_key)
    omits_unit = unit in UNSTATED_UNITS or name.endswith(unit)
    columns = [
        Column(
            name if omits_unit else f"{name}, {unit}", tooltip=f"{metric_key[0]} {metric_key[1]}"
        )
    ]
    if unit == "diagonal":
        columns.append(Column("mm", tooltip=f"{name} in mm"))
    if metric_key == EMD_EVEN:
        columns += [Column("floor"), Column("x floor")]
    return columns


def _name(metric_key: tuple[str, str]) -> str:
    metric, protocol = metric_key
    foreground_name = METRIC_NAMES.get((metric, "P1-union"))
    if protocol == "P1-frame" and foreground_name:
        return f"{foreground_name}, whole frame"
    return METRIC_NAMES.get(metric_key, f"{metric} ({protocol})")


def _score_cells(
    score: Score | None, metric_key: tuple[str, str], unit: str, part: Part
) -> list[str]:
    """The cells of the columns that `_columns` gives."""
    if score is None:
        return [""] * len(_columns(metric_key, unit))
    value = (
        format_fixed(score.value) if unit in FOUR_DECIMAL_UNITS else format_significant(score.value)
    )
    texts = [value + ("" if score.status == "ok" else " (failed)")]
    if unit == "diagonal":
        texts.append(format_significant(score.value * part.diagonal_mm))
    if metric_key == EMD_EVEN:
        texts += [f"{score.floor:.4f}", f"{score.value / score.floor:.2f}" if score.floor else ""]
    return texts


def _failures(study: Study, part: Part) -> str:
    return "".join(
        note(f"<b>{escape(stage)}</b> failed: {escape(failed[part.part_id])}")
        for stage, failed in study.failures.items()
        if part.part_id in failed
    )


def _input_warnings(study: Study, part: Part) -> str:
    return "".join(
        note(f"<b>{escape(method)}</b>: {escape('; '.join(messages[part.part_id]))}")
        for method, messages in study.input_warnings.items()
        if part.part_id in messages
    )
