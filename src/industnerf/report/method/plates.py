"""All plates of one part, in the order of the paper's figure 2."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from industnerf.config import load_params
from industnerf.geometry.cameras import framed_ball
from industnerf.methods.base import hand_over
from industnerf.methods.industnerf import METHODS
from industnerf.methods.industnerf.scene import Posed
from industnerf.report.method import inputs, judging, refining, seeing
from industnerf.report.method.making import Making, make
from industnerf.report.plates import png
from industnerf.seeds import seed_for

METHOD = METHODS["industnerf"]
# A plate is None where the settings leave out what it would show.
PLATES: dict[str, Callable[[Making], Any]] = {
    "01-views.png": inputs.views,
    "02-grid.png": inputs.cubes,
    "03-features.png": inputs.features,
    "04-field.png": inputs.field,
    "05-distribution.png": refining.distribution,
    "06-refined.png": refining.refined,
    "07-ray.png": seeing.ray,
    "08-rerendered.png": seeing.rerendered,
    "09-confidence.png": judging.confidence,
    "10-cloud.png": judging.cloud,
}


def of_part(views: Path) -> Making:
    """The study's run of the part whose photographs are in `views`."""
    params, part_id = load_params(), views.name
    given = hand_over(METHOD, views, views)  # the method takes nothing of the part itself
    centre, radius = framed_ball(given.cameras)
    seed = seed_for(params.seed, "reconstruct", METHOD.name, part_id)
    posed = Posed(given.rgb, given.cameras, None, centre, radius)
    return make(part_id, posed, params.method.industnerf, seed)


def write_plates(making: Making, out: Path) -> list[Path]:
    """Replace the plates in `out`; returns those that there are."""
    out.mkdir(parents=True, exist_ok=True)
    written = []
    for name, draw in PLATES.items():
        (out / name).unlink(missing_ok=True)
        drawn = draw(making)
        if drawn is not None:
            (out / name).write_bytes(png(drawn))
            written.append(out / name)
    return written
