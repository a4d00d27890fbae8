"""The linked 3-D viewer as it stands on the page: its controls, and the clouds it draws."""

import base64
import json
from collections.abc import Sequence
from html import escape

import numpy as np

from industnerf.artifacts.part import Part
from industnerf.report.html.markup import note
from industnerf.report.html.viewer_clouds import SHOWN_POINTS, ViewerScene
from industnerf.report.study import Study
from industnerf.report.tables.formats import format_significant
from industnerf.report.tables.score_lookup import Scores

COLORINGS = {
    "error": "error, mm",
    "confidence": "confidence",
    "view": "contributing view",
    "photo": "photo color",
}
LIMITS = (0.005, 0.01, 0.02, 0.05)  # ends of the color scale, in diagonals
COLOR_MAPS = {"error": "turbo", "confidence": "viridis"}  # matplotlib's names
HELP = (
    "Drag to turn, shift-drag to shift; once clicked, the wheel zooms and the arrow keys turn; "
    "a double click goes back. Both sides have one camera. Error is the distance to the true "
    "surface; on the truth's own side it is the distance to the nearest point of the other side's "
    f"cloud: what that one misses. Points are spread evenly, up to {SHOWN_POINTS} a cloud. Of several "
    "answers of a net the first that has points is shown; its EMD is the mean over all of them."
)


def viewer_html(study: Study, scores: Scores, scenes: Sequence[ViewerScene]) -> str:
    """The figure, and one JSON element a part beside it; says so where there is nothing to show."""
    if not scenes:
        return note("No part has both photographs and a true surface: there is nothing to show.")
    names = ["truth", *study.methods]
    panes = _pane("left", names, "truth") + _pane("right", names, names[min(1, len(names) - 1)])
    return (
        f"<div id=viewer><div class=bar>{_part_selector(scenes)}{_coloring_buttons()}{_limit_selector()}</div>"
        f"<div id=stage><canvas tabindex=0 aria-label='truth and reconstruction'></canvas>{panes}"
        f"</div><div id=legend></div>{note(HELP)}</div>"
        f"{_json_script('looks', {'maps': {name: _color_map_base64(kind) for name, kind in COLOR_MAPS.items()}})}"
        f"{''.join(_scene_json(scores, scene) for scene in scenes)}"
    )


def _part_selector(scenes: Sequence[ViewerScene]) -> str:
    options = "".join(
        f"<option value='{escape(s.part.part_id)}'>{escape(s.part.designation)}" for s in scenes
    )
    return (
        f"<label>part <select name=part>{options}</select></label>"
        "<a id=more href='#'>all its scores</a>"
    )


def _pane(side: str, names: Sequence[str], chosen: str) -> str:
    options = "".join(
        f"<option{' selected' if name == chosen else ''}>{escape(name)}" for name in names
    )
    return (
        f"<div class='pane {side}'><select aria-label='{side} side'>{options}</select>"
        "<div class=says></div></div>"
    )


def _coloring_buttons() -> str:
    buttons = "".join(
        f"<label class=choice><input type=radio name=coloring value={name}"
        f"{' checked' if name == 'error' else ''}> {text}</label>"
        for name, text in COLORINGS.items()
    )
    return f"<span>color: {buttons}</span>"


def _limit_selector() -> str:
    options = "".join(
        f"<option value={limit}{' selected' if limit == 0.02 else ''}>{100 * limit:g} %"
        for limit in LIMITS
    )
    return f"<label>scale ends at <select name=limit>{options}</select></label>"


def _scene_json(scores: Scores, scene: ViewerScene) -> str:
    packed = {
        name: cloud | {"says": _cloud_caption(scores, scene.part, name, cloud["says"])}
        for name, cloud in scene.clouds.items()
    }
    return _json_script(f"scene={scene.part.part_id}", scene.facts | {"packed": packed})


def _cloud_caption(scores: Scores, part: Part, name: str, caption: str) -> str:
    """What stands below the name of a cloud: its EMD, both ways, and how much of it is shown."""
    score = scores.get(part.part_id, name)
    if score is None:
        return caption
    emd = f"EMD {score.value:.4f} = {format_significant(score.value * part.diagonal_mm)} mm"
    ratio = f" ({score.value / score.floor:.2f} x floor)" if score.floor else ""
    return f"{emd}{ratio}; {caption}"


def _json_script(name: str, content: dict) -> str:
    text = json.dumps(content, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    return f"<script type='application/json' id='{escape(name)}'>{text}</script>"


def _color_map_base64(name: str) -> str:
    """The 256 colors of a color map, base64."""
    from matplotlib import colormaps

    colors = colormaps[name](np.arange(256), bytes=True)[:, :3]
    return base64.b64encode(colors.tobytes()).decode()
