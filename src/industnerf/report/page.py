"""One page that opens offline: everything it shows is inside it."""

import base64
from html import escape

from industnerf.report import table2
from industnerf.report.gather import Study
from industnerf.report.tables import COLUMNS, Extra, Row, cells, scores_of

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #222; max-width: 76rem; margin: 2rem auto;
       padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.2rem; margin-top: 2.2rem; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; font-size: .85rem; }
th, td { padding: .25rem .6rem; text-align: right; border-bottom: 1px solid #ddd; }
th:first-child, td:first-child, th:nth-child(2), td:nth-child(2) { text-align: left; }
tr.failed td { color: #b00020; } img { max-width: 100%; } .wide { overflow-x: auto; }
p.note { color: #555; max-width: 60rem; }
"""


BY_PART = (
    "<p class=note>EMD (even) of every method. <i>visible</i> is the share of the surface that can "
    "be seen from anywhere around the part, <i>seen</i> the share that its training views show; "
    "the strata are formulas on the mesh (docs/dataset.md).</p>"
)


def page(
    study: Study,
    rows: list[Row],
    extras: list[Extra],
    lines: list[table2.Line],
    sheet: bytes,
) -> str:
    """`report.html`."""
    picture = base64.b64encode(sheet).decode()
    return "".join(
        [
            "<!doctype html><html lang=en><meta charset=utf-8>",
            "<meta name=viewport content='width=device-width'>",
            f"<title>IndustNeRF: {escape(study.preset)}</title><style>{STYLE}</style>",
            f"<h1>IndustNeRF suite: {escape(study.preset)}</h1>{_summary(study)}",
            "<h2>Table 1</h2>",
            _table(
                list(COLUMNS),
                [(cells(r, e), r.failures > 0) for r, e in zip(rows, extras, strict=True)],
            ),
            _notes(),
            _table2(lines),
            "<h2>Contact sheet</h2>",
            f"<img alt='contact sheet' src='data:image/png;base64,{picture}'>",
            f"<h2>Part by part</h2>{BY_PART}{_by_part(study)}",
            _failures(study),
            "</html>\n",
        ]
    )


def _summary(study: Study) -> str:
    tested = sum(place.split == "test" for place in study.places.values())
    families = len({part.family for part in study.parts.values()})
    return (
        f"<p>{len(study.parts)} parts of {families} families, {study.views} training views each; "
        f"{tested} reported, {len(study.parts) - tested} set apart for tuning (dev).</p>"
    )


def _notes() -> str:
    return (
        "<p class=note>EMD is the exact Wasserstein-1 distance in units of the true bounding-box "
        "diagonal, on what the reference rig sees; <i>full</i> is of the whole surface. "
        "<i>floor</i> is the same metric between two independent samples of the truth: no method "
        "can do better. <i>even</i> compares geometry alone, <i>iid</i> geometry and density. "
        "The interval is a bootstrap over families. A failed part scores the worse of its ball "
        "and its box. A row marked null knows no picture of the part, a row marked bound is "
        "given the answer. A net is undertrained if its validation loss was still falling, or if "
        "retrieval or the mean shape is as good. The paper's numbers have no published "
        "protocol.</p>"
    )


def _table2(lines: list[table2.Line]) -> str:
    if not lines:
        return f"<p class=note>{table2.LEFT_OUT}</p>"
    shown = [(table2.cells(line), line.failures > 0) for line in lines]
    return (
        f"<h2>Table 2</h2>{_table(list(table2.COLUMNS), shown)}"
        "<p class=note>The held-out views, rendered by the method and photographed. RGB (linear, "
        "white is 1), PSNR and SSIM are over the pixels that show the part in truth or in the "
        "rendering (opacity of at least one half), and beside that over the whole frame. The error "
        "of depth (squared, bounding-box diagonal 1) is over the pixels where both have a depth; "
        "<i>coverage</i> is the share of the true foreground that has one. Over the whole frame, "
        "pixels that both leave empty count as right. <i>best</i> is the floor of the EMD, and of "
        "the others what nothing beats. Failed parts count in the EMD alone. <i>Confidence</i> is "
        "of all candidates within 5 % of the diagonal of the visible surface, against their "
        "distance to the true surface: rank correlation (-1 is best), and the area between the "
        "sparsification curves by confidence and by the true error, which is 0 for the true "
        "order. The paper does not say what its errors average over.</p>"
    )


def _table(heads: list[str], lines: list[tuple[list[str], bool]]) -> str:
    """A table without the columns that no line fills."""
    filled = [i for i in range(len(heads)) if any(texts[i] for texts, _ in lines)]
    heads = [heads[i] for i in filled]
    lines = [([texts[i] for i in filled], failed) for texts, failed in lines]
    head = "".join(f"<th>{escape(text)}" for text in heads)
    body = "".join(
        f"<tr{' class=failed' if failed else ''}>"
        + "".join(f"<td>{escape(text)}" for text in texts)
        for texts, failed in lines
    )
    return f"<div class=wide><table><tr>{head}{body}</table></div>"


def _by_part(study: Study) -> str:
    """EMD (even) of every part and method, with its floor."""
    even = {
        (s.part_id, s.method): s.score
        for split in ("test", "dev")
        for method in study.methods
        for s in scores_of(study, method, split)
        if (s.score.metric, s.score.protocol) == ("emd", "P1-even")
    }
    lines = []
    for part in sorted(study.parts.values(), key=lambda part: (part.family, part.part_id)):
        scores = [even.get((part.part_id, method)) for method in study.methods]
        known = next((score for score in scores if score), None)
        texts = [part.designation, part.family, study.places[part.part_id].split]
        texts += [", ".join(part.strata), f"{100 * part.visible_share:.0f} %"]
        seen = study.seen_by_training.get(part.part_id)
        texts += ["" if seen is None else f"{100 * seen:.0f} %"]
        texts += [f"{known.floor:.4f}" if known else ""]
        texts += [_value(score) for score in scores]
        lines.append((texts, any(score and score.status != "ok" for score in scores)))
    heads = ["part", "family", "split", "strata", "visible", "seen", "floor", *study.methods]
    return _table(heads, lines)


def _value(score) -> str:
    if score is None:
        return ""
    return f"{score.value:.4f}" + ("" if score.status == "ok" else " (failed)")


def _failures(study: Study) -> str:
    items = [
        f"<li><b>{escape(where)}</b>, {escape(part)}: {escape(why)}"
        for where, failed in study.failures.items()
        for part, why in failed.items()
    ]
    return f"<h2>Failures</h2><ul>{''.join(items)}</ul>" if items else ""
