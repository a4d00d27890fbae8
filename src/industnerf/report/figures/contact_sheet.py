"""The contact sheet: truth, an image, and the methods' clouds colored by their error."""

import io
from textwrap import wrap

import numpy as np
from jaxtyping import Float, UInt8
from scipy.spatial import cKDTree

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.part import Mesh, Part, load_mesh
from industnerf.artifacts.truth import Truth
from industnerf.artifacts.views import load_views
from industnerf.geometry.cameras import Cameras
from industnerf.methods.base import Method, Role
from industnerf.report.study import Study
from industnerf.splats import splat

IMAGE_PX, IMAGE_INCHES = 260, 2.0  # of one image
LABEL_INCHES, FONT_POINTS = 2.5, 14  # legible where a page shows the sheet smaller
LABEL_LETTERS = 18  # of a line of a label
MAX_ERROR = 0.05  # error in diagonals at the end of the color scale
VISIBLE_COLOR, HIDDEN_COLOR = np.array([70, 90, 120], np.uint8), np.array([225, 150, 60], np.uint8)


def draw_contact_sheet(study: Study, parts: list[Part]) -> bytes | None:
    """A PNG with a row for each of `parts` and a column for each method; None without a part.

    Nulls see no photograph, so they have a column only where there is nothing else.
    """
    if not parts:
        return None
    import matplotlib as mpl
    from matplotlib.figure import Figure

    color_map = mpl.colormaps["turbo"]
    methods = shown_methods(study.methods)
    heads = ["truth\n(orange: hidden)", "a view", *methods]
    width, height = IMAGE_INCHES * len(heads) + LABEL_INCHES, IMAGE_INCHES * len(parts) + 1.8
    figure = Figure(figsize=(width, height))
    axes = figure.subplots(len(parts), len(heads), squeeze=False)
    figure.subplots_adjust(
        left=LABEL_INCHES / width,
        right=1,
        top=1 - 0.6 / height,
        bottom=1.2 / height,
        wspace=0.02,
        hspace=0.02,
    )
    for row, part in zip(axes, parts, strict=True):
        for axis, image in zip(row, _row_images(study, part, methods, color_map), strict=True):
            axis.set(xticks=[], yticks=[], frame_on=False)
            if image is not None:
                axis.imshow(image)
            else:
                axis.text(0.5, 0.5, "failed", ha="center", va="center", transform=axis.transAxes)
        label = "\n".join([*wrap(part.designation, LABEL_LETTERS), f"({part.family})"])
        # parse_math: of own parts it holds the names of files, and a name may have dollars
        row[0].set_ylabel(
            label, rotation=0, ha="left", va="center", fontsize=FONT_POINTS, parse_math=False
        )
        row[0].yaxis.set_label_coords(-0.95 * LABEL_INCHES / IMAGE_INCHES, 0.5)
    for axis, head in zip(axes[0], heads, strict=True):
        axis.set_title(head, fontsize=FONT_POINTS)
    mappable = mpl.cm.ScalarMappable(mpl.colors.Normalize(0, 100 * MAX_ERROR), color_map)
    colorbar = figure.colorbar(
        mappable,
        cax=figure.add_axes((0.25, 0.8 / height, 0.5, 0.2 / height)),
        orientation="horizontal",
    )
    colorbar.set_label(
        "distance to the true surface, % of the bounding-box diagonal", fontsize=FONT_POINTS
    )
    colorbar.ax.tick_params(labelsize=FONT_POINTS)
    png = io.BytesIO()
    figure.savefig(png, dpi=130, metadata={"Software": None})
    return png.getvalue()


def shown_methods(methods: dict[str, Method]) -> list[str]:
    """Those with a column on the sheet."""
    return [name for name, method in methods.items() if method.role != Role.NULL] or list(methods)


def _row_images(
    study: Study, part: Part, methods: list[str], color_map
) -> list[UInt8[np.ndarray, "h w 3"] | None]:
    views = load_views(study.folders.views / part.part_id)
    view = int(views.train_indices[best_view(views.cameras[views.train_indices])])
    truth = Truth.load(study.folders.truth / part.part_id)
    surface = load_mesh(study.folders.parts / part.part_id)
    truth_colors = np.where(truth.visible[:, None], VISIBLE_COLOR, HIDDEN_COLOR)
    images = [splat(truth.points_mm, truth_colors, views.cameras, view, IMAGE_PX)]
    images.append(views.rgb(np.array([view]))[0])
    for method in methods:
        folder = study.folders.clouds / method / part.part_id
        if not folder.is_dir():
            images.append(None)
            continue
        points = Cloud.load(folder).points_mm
        max_error_mm = MAX_ERROR * part.diagonal_mm
        colors = color_map(cloud_to_surface_distances(points, surface) / max_error_mm, bytes=True)[
            :, :3
        ]
        images.append(splat(points, colors, views.cameras, view, IMAGE_PX))
    return images


def best_view(cameras: Cameras) -> int:
    """The index of the camera that looks most from the upper right, as drawings do."""
    center = cameras.centers.mean(axis=0)
    return int(np.argmax((cameras.centers - center) @ np.array([1.0, -1.2, 0.9])))


def truth_to_cloud_distances(
    truth_mm: Float[np.ndarray, "m 3"], points_mm: Float[np.ndarray, "n 3"], max_mm: float
) -> Float[np.ndarray, "m"]:
    """Distance (mm) of each sample of the truth to the nearest point, cut off at `max_mm`."""
    distances, _ = cKDTree(points_mm).query(truth_mm, distance_upper_bound=max_mm)
    return np.minimum(distances, max_mm)  # a search without result returns infinity


def cloud_to_surface_distances(
    points_mm: Float[np.ndarray, "n 3"], surface: Mesh
) -> Float[np.ndarray, "n"]:
    """Distance (mm) of each point to the true surface."""
    # late: a report without a figure need not wait for Warp
    from industnerf.geometry.surface_distance import distance_to_surface

    return distance_to_surface(points_mm, surface.vertices, surface.faces)
