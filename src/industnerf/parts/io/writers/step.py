"""STEP of a drawing, exact, or of a mesh, as flat facets.  Needs the `[cad]` extra.

Lengths are in mm.  OpenCASCADE takes linear colors and writes them in sRGB, as STEP has them.
"""

from pathlib import Path

from build123d import Color, Compound, Shape, export_step

from industnerf.artifacts.part import Appearance, Mesh
from industnerf.errors import BadPart
from industnerf.parts.catalogue.appearances import APPEARANCES
from industnerf.parts.catalogue.recipe import Assembly
from industnerf.parts.io.writers.facets import write_facets

MAX_FACETS = 50_000  # about 65 MB: what a CAD program still opens


def write_drawing(path: Path, drawing: Assembly) -> None:
    """The solids of a drawing without mesh booleans, each of the name and color of its finish.

    They overlap where the drawing has them overlap, as a thread and its shank do.  An only solid
    has the name of the part.
    """
    solids = [
        _label_solid(solid, APPEARANCES[name])
        for name, body in drawing.bodies.items()
        for solid in body.solids()
    ]
    whole = Compound(label=path.stem, children=solids) if len(solids) > 1 else solids[0]
    whole.label = path.stem
    export_step(whole, path)


def _label_solid(solid: Shape, finish: Appearance) -> Shape:
    solid.label, solid.color = finish.name, Color(*finish.albedo)
    return solid


def write_faceted(path: Path, mesh: Mesh, finishes: tuple[Appearance, ...]) -> None:
    """Every triangle as a plane face; raises BadPart above `MOST_FACETS` of them."""
    if len(mesh.faces) > MAX_FACETS:
        raise BadPart(
            f"{path.stem}: {len(mesh.faces)} facets, and a STEP file of more than {MAX_FACETS} "
            "is of no use to a CAD program. There is no exact drawing of this part; --format glb, "
            "ply, obj and stl have its mesh."
        )
    write_facets(path, mesh, finishes)
