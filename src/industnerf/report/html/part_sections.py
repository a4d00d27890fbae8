"""The section of every part on the page: what it is, and all its scores."""

from dataclasses import dataclass

from industnerf.artifacts.part import Part
from industnerf.artifacts.scores import Score
from industnerf.report.figures.held_out_renderings import PartImages
from industnerf.report.figures.sparsification import ERROR_LEFT_PREFIX
from industnerf.report.html.tables import Column, HtmlRow, HtmlTable, format_percent, html_table
from industnerf.report.study import Study
from industnerf.report.tables.formats import format_fixed, format_significant
from industnerf.report.tables.scores import EMD_EVEN, Scores
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
IMAGE_AND_CONFIDENCE_PROTOCOLS = ("P1-union", "P1-frame", "P1-near")
UNSTATED_UNITS = ("1", "diagonal")  # units that go without saying
FOUR_DECIMAL_UNITS = ("1", "diagonal", "share")  # the others range over many magnitudes


@dataclass(frozen=True)
class PartSection:
    """What templates/part_sections.html.j2 shows of one part."""

    part: Part
    neighbors: list[Part]  # before and after it
    is_in_viewer: bool
    images: list[tuple[str, bytes]]  # one view, photographed and rendered: name, JPEG
    facts: dict[str, str]
    tables: list[HtmlTable]
    failures: list[tuple[str, str]]  # stage or method, and the reason
    warnings: list[tuple[str, str]]  # stage or method, and what it said of the part or the images


def part_sections(
    study: Study, scores: Scores, in_viewer: set[str], part_images: PartImages
) -> list[PartSection]:
    """All sections, in the order of the table of parts."""
    parts = sorted(study.parts.values(), key=lambda part: (part.family, part.part_id))
    triples = zip([None, *parts], parts, [*parts[1:], None], strict=False)
    return [
        PartSection(
            part,
            [other for other in (before, after) if other],
            part.part_id in in_viewer,
            part_images.get(part.part_id, []),
            _facts(study, part),
            _tables(study, scores, part),
            [
                (stage, failed[part.part_id])
                for stage, failed in study.failures.items()
                if part.part_id in failed
            ],
            [
                (method, "; ".join(texts[part.part_id]))
                for method, texts in study.input_warnings.items()
                if part.part_id in texts
            ],
        )
        for before, part, after in triples
    ]


def _facts(study: Study, part: Part) -> dict[str, str]:
    assignment = study.assignments[part.part_id]
    size = " x ".join(format_significant(edge) for edge in part.extents_mm)
    return {
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


def _tables(study: Study, scores: Scores, part: Part) -> list[HtmlTable]:
    """Scores of the cloud, EMD first, then those of renderings and confidence."""
    units = scores.units_by_metric_key
    metric_keys = sorted(units, key=lambda metric_key: metric_key[0] != "emd")
    surface_keys = [key for key in metric_keys if key[1] not in IMAGE_AND_CONFIDENCE_PROTOCOLS]
    image_keys = [  # without the points of the sparsification curve, whose area is there
        key
        for key in metric_keys
        if key[1] in IMAGE_AND_CONFIDENCE_PROTOCOLS and not key[0].startswith(ERROR_LEFT_PREFIX)
    ]
    tables = (
        _score_table(study, scores, part, {key: units[key] for key in keys})
        for keys in (surface_keys, image_keys)
    )
    return [table for table in tables if table.rows]


def _score_table(
    study: Study, scores: Scores, part: Part, units: dict[tuple[str, str], str]
) -> HtmlTable:
    """One row for every method that has a score of a metric in `units`."""
    columns = [Column("method", True)]
    columns += [
        column for metric_key, unit in units.items() for column in _columns(metric_key, unit)
    ]
    rows = []
    for method in study.methods:
        method_scores = {key: scores.get(part.part_id, method, key) for key in units}
        texts = [
            text
            for key, unit in units.items()
            for text in _score_cells(method_scores[key], key, unit, part)
        ]
        failed = any(score and score.status != "ok" for score in method_scores.values())
        if any(texts):
            rows.append(HtmlRow([method, *texts], "failed" if failed else ""))
    return html_table(columns, rows)


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
    """The cells of the columns of `_columns`."""
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
