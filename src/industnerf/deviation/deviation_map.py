"""A cloud and a CAD file to a deviation map: a page, a table of points, and numbers."""

from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float
from PIL import Image
from scipy.spatial import cKDTree

from industnerf.artifacts.files import atomic_write, write_json, write_text
from industnerf.config import find_params, load_params
from industnerf.deviation.picture import deviation_colors, deviation_picture
from industnerf.deviation.registration import IDENTITY, Registration, register, size_ratio
from industnerf.deviation.scale import require_size, scale_warning
from industnerf.deviation.statistics import DeviationStatistics, deviation_statistics, histogram
from industnerf.deviation.surface import Surface
from industnerf.errors import BadArtifact, BadParams
from industnerf.external.points import read_cloud
from industnerf.geometry.sampling import sample_surface
from industnerf.parts.io.readers import read_solids
from industnerf.parts.io.units import MM_PER_UNIT, unit_note
from industnerf.parts.repair import repair_mesh
from industnerf.report.html.cloud_page import ColorScale, ShownCloud, render_cloud_page
from industnerf.seeds import generator

DRAWN = 65536  # points of a mesh, and samples of the CAD surface
STRAY_SHARE = 0.05  # of the diagonal, beyond which a point is not of the part
POOR_FIT = 0.01  # mean distance in diagonals, from which the cloud hardly looks like the part
AMBIGUOUS = 1.05  # times the cost, up to which another pose fits as well
SPACINGS = 3.0  # mean distances between points, within which the surface counts as covered
SCALE_FACTORS = (1.0, 2.0, 5.0, 10.0, 20.0)  # ends of the color scale, in tolerances
NOTE = (
    "Both sides share one camera. Red is outside the CAD surface, blue inside. Of the CAD surface, "
    "distance is that to the nearest point of the cloud: what was not measured."
)


@dataclass(frozen=True)
class Inputs:
    """The cloud in mm, the CAD surface, and what was remarked on either."""

    points: Float[np.ndarray, "n 3"]
    surface: Surface
    warnings: list[str]


def deviation_map(
    cloud: Path,
    cad: Path,
    tolerance: float,
    units: str,
    cad_units: str,
    with_scale: bool,
    in_place: bool,
    max_distance: float | None,
    out: Path | None,
    png: bool,
) -> None:
    """Write the map of `cloud` against `cad`; lengths are in mm.

    Raises BadArtifact or BadPart if a file cannot be read, BadParams if the cloud is of another
    size than the part, or `out` is no page.
    """
    page = Path(f"{cloud.name}.deviation.html") if out is None else out
    if page.suffix.lower() != ".html":
        raise BadParams(f"--out {page}: must end in .html")
    inputs = _read(cloud, cad, MM_PER_UNIT[units], cad_units)
    points, surface = inputs.points, inputs.surface
    if not with_scale:
        require_size(size_ratio(points, surface))
    registration = Registration(IDENTITY, 0.0, None)
    if not in_place:
        registration = register(points, surface, with_scale=with_scale)
        inputs.warnings.extend(_fit_warnings(points, surface, registration, with_scale))
    moved = registration.move(points)
    deviation = surface.nearest(moved).signed_distance
    samples = sample_surface(
        surface.vertices, surface.faces, DRAWN, generator(0, "deviation", cad.name)
    )[0]
    tree = cKDTree(moved)
    gaps = tree.query(samples)[0]
    spacing = float(np.median(tree.query(moved[:: max(1, len(moved) // 4096)], 2)[0][:, -1]))
    stray_mm = STRAY_SHARE * surface.diagonal if max_distance is None else max_distance
    if not (np.abs(deviation) <= stray_mm).any():
        raise BadArtifact(
            f"no point of {cloud} is within {stray_mm:.4g} mm of {cad}: without --in-place it is "
            "moved there; --max-distance sets what counts"
        )
    statistics = deviation_statistics(
        deviation, tolerance, stray_mm, gaps, max(tolerance, SPACINGS * spacing)
    )
    _write(page, cloud, cad, moved, deviation, samples, gaps, statistics, registration, inputs, png)


def _read(cloud: Path, cad: Path, mm: float, cad_units: str) -> Inputs:
    for file in (cloud, cad):
        if not file.is_file():
            raise BadArtifact(f"{file} is no file")
    content = read_cloud(cloud, DRAWN, generator(0, "deviation", cloud.name))
    solids = read_solids(cad, cad_units)
    repair = load_params(find_params()).parts.repair
    repaired = repair_mesh([solid.mesh for solid in solids.solids], repair)
    surface = Surface(repaired.mesh.vertices, repaired.mesh.faces)
    note = unit_note(solids.unit, float(np.ptp(repaired.mesh.vertices, axis=0).max()))
    warnings = [f"{cloud.name}: {text}" for text in content.warnings]
    warnings += [
        f"{cad.name}: {text}"
        for text in (*solids.warnings, *repaired.residual_defects, *filter(None, [note]))
    ]
    return Inputs(mm * content.points, surface, warnings)


def _fit_warnings(
    points: np.ndarray, surface: Surface, registration: Registration, with_scale: bool
) -> list[str]:
    warnings = []
    if registration.cost > POOR_FIT * surface.diagonal:
        warnings.append(
            f"it fits badly: {registration.cost:.3g} mm from the surface on average, of a part of "
            f"{surface.diagonal:.4g} mm; is it this part, and cut out from what is around it?"
        )
    if (
        registration.runner_up is not None
        and registration.runner_up < AMBIGUOUS * registration.cost
    ):
        warnings.append(
            "another pose fits as well, for the part is nearly symmetric: what breaks the symmetry "
            "may be compared with its opposite"
        )
    if with_scale:
        scale = registration.move.scale
        warnings.append(
            f"its scale was fitted, {scale:.6g}: an error of the overall size is hidden"
        )
    elif warning := scale_warning(points, surface, registration):
        warnings.append(warning)
    return warnings


def _write(
    page: Path,
    cloud: Path,
    cad: Path,
    moved: np.ndarray,
    deviation: np.ndarray,
    samples: np.ndarray,
    gaps: np.ndarray,
    statistics: DeviationStatistics,
    registration: Registration,
    inputs: Inputs,
    png: bool,
) -> None:
    ends = [factor * statistics.tolerance_mm for factor in SCALE_FACTORS]
    start = next((end for end in ends if end >= statistics.p95_abs_mm), ends[-1])
    measured, nominal = (
        f"{file.name}{' (CAD)' if cloud.name == cad.name and file is cad else ''}"
        for file in (cloud, cad)
    )
    clouds = [
        ShownCloud(measured, moved, "measured", error=np.abs(deviation), deviation=deviation),
        ShownCloud(nominal, samples, "CAD", error=gaps),
    ]
    title = f"Deviation of {cloud.name} from {cad.name}"
    lines = summary_lines(statistics)
    counts, edges = histogram(deviation[np.abs(deviation) <= statistics.stray_mm], start)
    text = render_cloud_page(
        "deviation.html.j2",
        title,
        clouds,
        "mm",
        ColorScale(ends, start, tolerance=statistics.tolerance_mm),
        NOTE,
        warnings=inputs.warnings,
        facts=lines,
        matrix=registration.move.matrix().tolist(),
        bars=_bars(counts, edges, statistics.tolerance_mm),
        end=f"{start:.3g}",
    )
    write_text(page, text)
    table = np.column_stack([moved, deviation])
    with atomic_write(page.with_suffix(".csv")) as draft:
        header = "x_mm,y_mm,z_mm,deviation_mm"
        np.savetxt(draft, table, fmt="%.6g", delimiter=",", header=header, comments="")
    numbers = asdict(statistics) | {"move": registration.move.matrix().tolist()}
    write_json(page.with_suffix(".json"), {"schema": 1, **numbers, "warnings": inputs.warnings})
    for name, value in lines.items():
        print(f"{name}: {value}")
    for warning in inputs.warnings:
        print(f"warning: {warning}")
    print(f"written: {page}, {page.with_suffix('.csv')}, {page.with_suffix('.json')}")
    if png:
        with atomic_write(page.with_suffix(".png")) as draft:
            tolerance = statistics.tolerance_mm
            image = deviation_picture(moved, deviation, start, tolerance, title)
            Image.fromarray(image).save(draft, "PNG")
        print(f"picture: {page.with_suffix('.png')}")


def summary_lines(statistics: DeviationStatistics) -> dict[str, str]:
    """The numbers for people, by what they are."""
    s = statistics
    return {
        "within tolerance": f"{s.within_tolerance:.1%} within {s.tolerance_mm:g} mm; "
        f"{s.above:.1%} above, {s.below:.1%} below",
        "mean": f"{s.mean_mm:+.4f} mm, standard deviation {s.std_mm:.4f} mm, RMS {s.rms_mm:.4f} mm",
        "its size": f"median {s.median_abs_mm:.4f} mm, 95 % below {s.p95_abs_mm:.4f} mm",
        "extremes": f"{s.min_mm:+.4f} mm to {s.max_mm:+.4f} mm",
        "points": f"{s.points - s.strays} of {s.points}; {s.strays} are strays, farther than "
        f"{s.stray_mm:.3g} mm",
        "CAD surface": f"{s.covered:.1%} has a point within {s.covered_mm:.3g} mm",
    }


def _bars(counts: np.ndarray, edges: np.ndarray, tolerance: float) -> list[dict[str, object]]:
    """The bars of the histogram: height in per cent of the highest, color, and what it counts."""
    middles = (edges[:-1] + edges[1:]) / 2
    colors = deviation_colors(middles, float(edges[-1]))
    return [
        {
            "height": 100 * count / max(counts.max(), 1),
            "color": f"rgb({r},{g},{b})",
            "inside": abs(middle) <= tolerance,
            "text": f"{low:+.3g} to {high:+.3g} mm: {count} points",
        }
        for count, middle, low, high, (r, g, b) in zip(
            counts, middles, edges[:-1], edges[1:], colors, strict=True
        )
    ]
