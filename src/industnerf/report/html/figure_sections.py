"""The figures of the page beside the viewer: distributions, calibration, renderings, failures."""

from collections.abc import Iterator
from html import escape

from industnerf.report.figures.held_out_renderings import HeldOutRenderings
from industnerf.report.figures.strip_plots import Dot, strip_plot
from industnerf.report.html import captions
from industnerf.report.html.markup import image_html, note, part_link
from industnerf.report.study import Study
from industnerf.report.tables.score_lookup import AUSE, AUSE_RANDOM, EMD_EVEN, SPEARMAN, Scores


def distribution_html(study: Study, scores: Scores) -> str:
    """EMD (even) in floors, every part of every method; empty if there is no score."""
    rows = {
        method: [
            Dot(part, score.value / score.floor, score.status != "ok")
            for part in study.parts
            if (score := scores.get(part, method, EMD_EVEN)) and score.value > 0 < score.floor
        ]
        for method in study.methods
    }
    svg = strip_plot(rows, "EMD (even) / floor", log=True, best=1.0)
    return svg and svg + note(captions.DISTRIBUTION)


def calibration_html(study: Study, scores: Scores, curves_png: bytes | None) -> str:
    """Rank correlation and AUSE of every part that has them; empty if none does.

    `curves` is a PNG of the curves that AUSE is made of.
    """
    correlations, areas = {}, {}
    for method in study.methods:
        correlations[method], areas[method] = [], []
        for part in study.parts:
            correlation = scores.get(part, method, SPEARMAN)
            area, random_area = (scores.get(part, method, key) for key in (AUSE, AUSE_RANDOM))
            if correlation:
                correlations[method].append(Dot(part, correlation.value))
            if area and random_area and random_area.value > 0:
                areas[method].append(Dot(part, area.value / random_area.value))
    figures = strip_plot(correlations, "rank correlation of confidence and error", best=-1.0)
    figures += strip_plot(areas, "AUSE / AUSE of a random order", best=0.0)
    figures = figures and figures + note(captions.CALIBRATION)
    if curves_png:
        figures += image_html("png", curves_png, "sparsification curves", "front") + note(
            captions.CURVES
        )
    return figures


def renderings_html(renderings: HeldOutRenderings) -> str:
    """Held-out photographs beside every renderer's answer; empty if no method renders."""
    views = max((len(pictures) for _, pictures in renderings.rows), default=0)
    if not views:
        return ""
    heads = ["photograph", *renderings.methods] * views
    head = "".join(f"<th class=text scope=col>{escape(name)}" for name in ["part", *heads])
    body = "".join(
        f"<tr><td>{part_link(part.part_id, part.designation)}"
        + "".join(_image_cells(part.designation, ["photograph", *renderings.methods], views))
        for part, views in renderings.rows
    )
    return (
        f"{note(captions.RENDERINGS)}<div class=wide><table class=views><thead><tr>{head}</thead>"
        f"<tbody>{body}</tbody></table></div>"
    )


def _image_cells(part: str, names: list[str], views: list[list[bytes | None]]) -> Iterator[str]:
    for view_number, images in enumerate(views, start=1):
        for name, image in zip(names, images, strict=True):
            alt_text = f"{part}, held-out view {view_number}: {name}"
            yield f"<td>{'failed' if image is None else image_html('jpeg', image, alt_text)}"


def failures_html(study: Study) -> str:
    """Every failure with its reason; empty if there is none."""
    return _message_list(study, study.failures)


def warnings_html(study: Study) -> str:
    """What methods said of the images they were given, by part; empty if nothing."""
    joined = {
        method: {part: "; ".join(messages) for part, messages in parts.items()}
        for method, parts in study.input_warnings.items()
    }
    return _message_list(study, joined)


def _message_list(study: Study, messages: dict[str, dict[str, str]]) -> str:
    """Who said what of which part."""
    items = "".join(
        f"<li><b>{escape(source)}</b>, {_part_label(study, part)}: {escape(text)}"
        for source, parts in messages.items()
        for part, text in parts.items()
    )
    return items and f"<ul>{items}</ul>"


def _part_label(study: Study, part: str) -> str:
    """A part that could not be read has no section to lead to."""
    return part_link(part, part) if part in study.parts else escape(part)
