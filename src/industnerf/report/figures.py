"""The figures of the page beside the viewer: distributions, calibration, renderings, failures."""

from collections.abc import Iterator
from html import escape

from industnerf.report import texts
from industnerf.report.gather import Study
from industnerf.report.lookup import AUSE, CHANCE, EVEN, SPEARMAN, Scores
from industnerf.report.markup import note, part_link, picture
from industnerf.report.snapshots import Snapshots
from industnerf.report.strips import Dot, strips


def distribution(study: Study, scores: Scores) -> str:
    """EMD (even) in floors, every part of every method; empty if there is no score."""
    rows = {
        method: [
            Dot(part, score.value / score.floor, score.status != "ok")
            for part in study.parts
            if (score := scores.get(part, method, EVEN)) and score.value > 0 < score.floor
        ]
        for method in study.methods
    }
    drawn = strips(rows, "EMD (even) / floor", log=True, best=1.0)
    return drawn and drawn + note(texts.DISTRIBUTION)


def calibration(study: Study, scores: Scores, curves: bytes | None) -> str:
    """Rank correlation and AUSE of every part that has them; empty if none does.

    `curves` is a PNG of the curves that AUSE is made of.
    """
    correlations, areas = {}, {}
    for method in study.methods:
        correlations[method], areas[method] = [], []
        for part in study.parts:
            correlation = scores.get(part, method, SPEARMAN)
            area, chance = (scores.get(part, method, kind) for kind in (AUSE, CHANCE))
            if correlation:
                correlations[method].append(Dot(part, correlation.value))
            if area and chance and chance.value > 0:
                areas[method].append(Dot(part, area.value / chance.value))
    drawn = strips(correlations, "rank correlation of confidence and error", best=-1.0)
    drawn += strips(areas, "AUSE / AUSE of a random order", best=0.0)
    drawn = drawn and drawn + note(texts.CALIBRATION)
    if curves:
        drawn += picture("png", curves, "sparsification curves", "front") + note(texts.CURVES)
    return drawn


def renderings(taken: Snapshots) -> str:
    """Held-out photographs beside every renderer's answer; empty if no method renders."""
    views = max((len(pictures) for _, pictures in taken.rows), default=0)
    if not views:
        return ""
    heads = ["photograph", *taken.methods] * views
    head = "".join(f"<th class=text scope=col>{escape(name)}" for name in ["part", *heads])
    body = "".join(
        f"<tr><td>{part_link(part.part_id, part.designation)}"
        + "".join(_cells(part.designation, ["photograph", *taken.methods], views))
        for part, views in taken.rows
    )
    return (
        f"{note(texts.RENDERINGS)}<div class=wide><table class=views><thead><tr>{head}</thead>"
        f"<tbody>{body}</tbody></table></div>"
    )


def _cells(part: str, names: list[str], views: list[list[bytes | None]]) -> Iterator[str]:
    for number, pictures in enumerate(views, start=1):
        for name, content in zip(names, pictures, strict=True):
            about = f"{part}, held-out view {number}: {name}"
            yield f"<td>{'failed' if content is None else picture('jpeg', content, about)}"


def failures(study: Study) -> str:
    """Every failure with its reason; empty if there is none."""
    return _listed(study, study.failures)


def remarks(study: Study) -> str:
    """What methods said of the images they were given, by part; empty if nothing."""
    joined = {
        method: {part: "; ".join(said) for part, said in parts.items()}
        for method, parts in study.remarks.items()
    }
    return _listed(study, joined)


def _listed(study: Study, said: dict[str, dict[str, str]]) -> str:
    """Who said what of which part."""
    items = "".join(
        f"<li><b>{escape(who)}</b>, {_named(study, part)}: {escape(text)}"
        for who, parts in said.items()
        for part, text in parts.items()
    )
    return items and f"<ul>{items}</ul>"


def _named(study: Study, part: str) -> str:
    """A part that could not be read has no section to lead to."""
    return part_link(part, part) if part in study.parts else escape(part)
