"""The contact sheet: truth, a photograph, and every method's cloud coloured by its error."""

import io
from textwrap import wrap

import numpy as np
from jaxtyping import UInt8

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.part import Part, load_mesh
from industnerf.artifacts.truth import Truth
from industnerf.artifacts.views import load_views
from industnerf.report.gather import Study
from industnerf.report.pictures import deviation, nicest_view
from industnerf.splats import splat

SIZE = 260  # px of one picture
CELL = 2.0  # inches of one picture
LABEL, FONT = 2.5, 14  # inches beside a row, and points: to be read when a page shows it smaller
LETTERS = 18  # of a line of a label
WORST = 0.05  # error in diagonals at the end of the colour scale
SEEN, HIDDEN = np.array([70, 90, 120], np.uint8), np.array([225, 150, 60], np.uint8)


def contact_sheet(study: Study, parts: list[Part]) -> bytes | None:
    """A PNG with a row for each of `parts` and a column for each method; None without a part."""
    if not parts:
        return None
    import matplotlib as mpl
    from matplotlib.figure import Figure

    colour_map = mpl.colormaps["turbo"]
    heads = ["truth\n(orange: hidden)", "a view", *study.methods]
    wide, high = CELL * len(heads) + LABEL, CELL * len(parts) + 1.8
    figure = Figure(figsize=(wide, high))
    axes = figure.subplots(len(parts), len(heads), squeeze=False)
    figure.subplots_adjust(
        left=LABEL / wide, right=1, top=1 - 0.6 / high, bottom=1.2 / high, wspace=0.02, hspace=0.02
    )
    for row, part in zip(axes, parts, strict=True):
        for axis, picture in zip(row, _pictures(study, part, colour_map), strict=True):
            axis.set(xticks=[], yticks=[], frame_on=False)
            if picture is not None:
                axis.imshow(picture)
            else:
                axis.text(0.5, 0.5, "failed", ha="center", va="center", transform=axis.transAxes)
        label = "\n".join([*wrap(part.designation, LETTERS), f"({part.family})"])
        # parse_math: of own parts it holds the names of files, and a name may have dollars
        row[0].set_ylabel(
            label, rotation=0, ha="left", va="center", fontsize=FONT, parse_math=False
        )
        row[0].yaxis.set_label_coords(-0.95 * LABEL / CELL, 0.5)
    for axis, head in zip(axes[0], heads, strict=True):
        axis.set_title(head, fontsize=FONT)
    scale = mpl.cm.ScalarMappable(mpl.colors.Normalize(0, 100 * WORST), colour_map)
    bar = figure.colorbar(
        scale, cax=figure.add_axes((0.25, 0.8 / high, 0.5, 0.2 / high)), orientation="horizontal"
    )
    bar.set_label("distance to the true surface, % of the bounding-box diagonal", fontsize=FONT)
    bar.ax.tick_params(labelsize=FONT)
    png = io.BytesIO()
    figure.savefig(png, dpi=130, metadata={"Software": None})
    return png.getvalue()


def _pictures(study: Study, part: Part, colour_map) -> list[UInt8[np.ndarray, "h w 3"] | None]:
    views = load_views(study.folders.views / part.part_id)
    view = int(views.train[nicest_view(views.cameras[views.train])])
    truth = Truth.load(study.folders.truth / part.part_id)
    surface = load_mesh(study.folders.parts / part.part_id)
    shown = np.where(truth.visible[:, None], SEEN, HIDDEN)
    pictures = [splat(truth.points_mm, shown, views.cameras, view, SIZE)]
    pictures.append(views.rgb(np.array([view]))[0])
    for method in study.methods:
        folder = study.folders.clouds / method / part.part_id
        if not folder.is_dir():
            pictures.append(None)
            continue
        points = Cloud.load(folder).points_mm
        worst = WORST * part.diagonal_mm
        colours = colour_map(deviation(points, surface) / worst, bytes=True)[:, :3]
        pictures.append(splat(points, colours, views.cameras, view, SIZE))
    return pictures
