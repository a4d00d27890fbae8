"""A section of the page for every part: what it is, and all its scores."""

from html import escape

from industnerf.artifacts.part import Part
from industnerf.artifacts.scores import Score
from industnerf.report.formats import brief, short
from industnerf.report.gather import Study
from industnerf.report.headline import percent
from industnerf.report.lookup import EVEN, Scores
from industnerf.report.markup import (
    Column,
    Line,
    note,
    part_anchor,
    part_link,
    picture,
    table,
)
from industnerf.report.snapshots import Album
from industnerf.report.sparsification import LEFT
from industnerf.report.table2 import LOSSES

NAMES = {  # as people say them; what is not here keeps the name it has in scores.csv
    EVEN: "EMD (even)",
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
BEYOND = ("P1-union", "P1-frame", "P1-near")  # protocols of renderings and of confidence
BARE = ("1", "diagonal")  # units that go without saying
FOUR_DIGITS = ("1", "diagonal", "share")  # the others range over many magnitudes


def part_pages(study: Study, scores: Scores, in_viewer: set[str], album: Album) -> str:
    """All sections, in the order of their table; each shows when the page is opened at it."""
    parts = sorted(study.parts.values(), key=lambda part: (part.family, part.part_id))
    around = zip([None, *parts], parts, [*parts[1:], None], strict=False)
    return "".join(
        f"<section class=part id='{escape(part_anchor(part.part_id))}'>"
        f"<h2>{escape(part.designation)}</h2>"
        f"<nav>{_ways(part, before, after, in_viewer)}</nav>"
        f"{_pictures(album.get(part.part_id, []))}{_section(study, scores, part)}</section>"
        for before, part, after in around
    )


def _ways(part: Part, before: Part | None, after: Part | None, in_viewer: set[str]) -> str:
    """Links to where one may want to go from here."""
    ways = ["<a href='#part-by-part'>all parts</a>"]
    ways += [part_link(other.part_id, other.designation) for other in (before, after) if other]
    if part.part_id in in_viewer:
        ways.append(
            f"<a href='#viewer' data-scene='{escape(part.part_id)}'>show it in the viewer</a>"
        )
    return "".join(ways)


def _pictures(seen: list[tuple[str, bytes]]) -> str:
    """One view, photographed and rendered; empty if nobody photographed it."""
    figures = "".join(
        f"<figure>{picture('jpeg', content, name)}<figcaption>{escape(name)}</figcaption></figure>"
        for name, content in seen
    )
    return figures and f"<div class=album>{figures}</div>"


def _section(study: Study, scores: Scores, part: Part) -> str:
    kinds = dict(sorted(scores.kinds().items(), key=lambda kind: kind[0][0] != "emd"))
    surface = {kind: unit for kind, unit in kinds.items() if kind[1] not in BEYOND}
    beyond = {  # but for the points of a curve, whose area stands there
        kind: unit
        for kind, unit in kinds.items()
        if kind[1] in BEYOND and not kind[0].startswith(LEFT)
    }
    return (
        f"{_facts(study, part)}{_scores(study, scores, part, surface)}"
        f"{_scores(study, scores, part, beyond)}{_failures(study, part)}{_remarks(study, part)}"
    )


def _facts(study: Study, part: Part) -> str:
    place = study.places[part.part_id]
    size = " x ".join(brief(edge) for edge in part.extents_mm)
    facts = {
        "id": part.part_id,
        "family": part.family,
        "split": place.split + ("" if place.fold is None else f", fold {place.fold}"),
        "size": f"{size} mm, diagonal {brief(part.diagonal_mm)} mm",
        "strata": ", ".join(part.strata),
        "surface": f"{part.area_mm2:.0f} mm\u00b2, {percent(part.visible_share)} visible",
        "seen by training views": percent(study.seen_by_training.get(part.part_id)),
        "bodies": str(part.bodies),
        "defects": "; ".join(part.defects),
    }
    rows = "".join(f"<dt>{name}<dd>{escape(text)}" for name, text in facts.items() if text)
    return f"<dl class=facts>{rows}</dl>"


def _scores(study: Study, scores: Scores, part: Part, kinds: dict[tuple[str, str], str]) -> str:
    """One row a method; empty where no method has a score of one of `kinds`."""
    columns, lines = [Column("method", True)], []
    for kind, unit in kinds.items():
        columns += _columns(kind, unit)
    for method in study.methods:
        found = {kind: scores.get(part.part_id, method, kind) for kind in kinds}
        texts = [text for kind in kinds for text in _texts(found[kind], kind, kinds[kind], part)]
        failed = any(score and score.status != "ok" for score in found.values())
        if any(texts):
            lines.append(Line([escape(method), *texts], "failed" if failed else ""))
    return table(columns, lines) if lines else ""


def _columns(kind: tuple[str, str], unit: str) -> list[Column]:
    name = _name(kind)
    stated = unit in BARE or name.endswith(unit)
    columns = [Column(name if stated else f"{name}, {unit}", about=f"{kind[0]} {kind[1]}")]
    if unit == "diagonal":
        columns.append(Column("mm", about=f"{name} in mm"))
    if kind == EVEN:
        columns += [Column("floor"), Column("x floor")]
    return columns


def _name(kind: tuple[str, str]) -> str:
    metric, protocol = kind
    over_part = NAMES.get((metric, "P1-union"))
    if protocol == "P1-frame" and over_part:
        return f"{over_part}, whole frame"
    return NAMES.get(kind, f"{metric} ({protocol})")


def _texts(score: Score | None, kind: tuple[str, str], unit: str, part: Part) -> list[str]:
    """The cells of the columns that `_columns` gives."""
    if score is None:
        return [""] * len(_columns(kind, unit))
    value = short(score.value) if unit in FOUR_DIGITS else brief(score.value)
    texts = [value + ("" if score.status == "ok" else " (failed)")]
    if unit == "diagonal":
        texts.append(brief(score.value * part.diagonal_mm))
    if kind == EVEN:
        texts += [f"{score.floor:.4f}", f"{score.value / score.floor:.2f}" if score.floor else ""]
    return texts


def _failures(study: Study, part: Part) -> str:
    return "".join(
        note(f"<b>{escape(where)}</b> failed: {escape(failed[part.part_id])}")
        for where, failed in study.failures.items()
        if part.part_id in failed
    )


def _remarks(study: Study, part: Part) -> str:
    return "".join(
        note(f"<b>{escape(method)}</b>: {escape('; '.join(said[part.part_id]))}")
        for method, said in study.remarks.items()
        if part.part_id in said
    )
