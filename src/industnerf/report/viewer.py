"""The linked 3-D viewer as it stands on the page: its controls, and the clouds it draws."""

import base64
import json
from collections.abc import Sequence
from html import escape

import numpy as np

from industnerf.artifacts.part import Part
from industnerf.report.formats import brief
from industnerf.report.gather import Study
from industnerf.report.lookup import Scores
from industnerf.report.markup import note
from industnerf.report.scenes import POINTS, Scene

COLOURINGS = {
    "error": "error, mm",
    "confidence": "confidence",
    "view": "contributing view",
    "photo": "photo colour",
}
LIMITS = (0.005, 0.01, 0.02, 0.05)  # ends of the colour scale, in diagonals
MAPS = {"error": "turbo", "confidence": "viridis"}  # matplotlib's names
HELP = (
    "Drag to turn, shift-drag to shift; once clicked, the wheel zooms and the arrow keys turn; "
    "a double click goes back. Both sides have one camera. Error is the distance to the true "
    "surface; on the truth's own side it is the distance to the nearest point of the other side's "
    f"cloud: what that one misses. Points are spread evenly, up to {POINTS} a cloud. Of several "
    "answers of a net the first that has points is shown; its EMD is the mean over all of them."
)


def viewer(study: Study, scores: Scores, scenes: Sequence[Scene]) -> str:
    """The figure, and one JSON element a part beside it; says so where there is nothing to show."""
    if not scenes:
        return note("No part has both photographs and a true surface: there is nothing to show.")
    names = ["truth", *study.methods]
    panes = _pane("left", names, "truth") + _pane("right", names, names[min(1, len(names) - 1)])
    return (
        f"<div id=viewer><div class=bar>{_parts(scenes)}{_colourings()}{_limits()}</div>"
        f"<div id=stage><canvas tabindex=0 aria-label='truth and reconstruction'></canvas>{panes}"
        f"</div><div id=legend></div>{note(HELP)}</div>"
        f"{_json('looks', {'maps': {name: _map(kind) for name, kind in MAPS.items()}})}"
        f"{''.join(_scene(scores, scene) for scene in scenes)}"
    )


def _parts(scenes: Sequence[Scene]) -> str:
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


def _colourings() -> str:
    buttons = "".join(
        f"<label class=choice><input type=radio name=colouring value={name}"
        f"{' checked' if name == 'error' else ''}> {text}</label>"
        for name, text in COLOURINGS.items()
    )
    return f"<span>colour: {buttons}</span>"


def _limits() -> str:
    options = "".join(
        f"<option value={limit}{' selected' if limit == 0.02 else ''}>{100 * limit:g} %"
        for limit in LIMITS
    )
    return f"<label>scale ends at <select name=limit>{options}</select></label>"


def _scene(scores: Scores, scene: Scene) -> str:
    packed = {
        name: cloud | {"says": _says(scores, scene.part, name, cloud["says"])}
        for name, cloud in scene.clouds.items()
    }
    return _json(f"scene={scene.part.part_id}", scene.facts | {"packed": packed})


def _says(scores: Scores, part: Part, name: str, says: str) -> str:
    """What stands below the name of a cloud: its EMD, both ways, and how much of it is shown."""
    score = scores.get(part.part_id, name)
    if score is None:
        return says
    emd = f"EMD {score.value:.4f} = {brief(score.value * part.diagonal_mm)} mm"
    ratio = f" ({score.value / score.floor:.2f} x floor)" if score.floor else ""
    return f"{emd}{ratio}; {says}"


def _json(name: str, content: dict) -> str:
    text = json.dumps(content, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    return f"<script type='application/json' id='{escape(name)}'>{text}</script>"


def _map(name: str) -> str:
    """The 256 colours of a colour map, base64."""
    from matplotlib import colormaps

    colours = colormaps[name](np.arange(256), bytes=True)[:, :3]
    return base64.b64encode(colours.tobytes()).decode()
