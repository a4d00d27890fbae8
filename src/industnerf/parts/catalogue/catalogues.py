"""The catalogues: where each lies, and the recipes of its parts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, Protocol, runtime_checkable

from industnerf.artifacts.part import Appearance, Mesh
from industnerf.errors import BadParams, SuiteError
from industnerf.parts.catalogue.entries import EMBEDDED_FOLDER

CATALOGUE_FOLDERS = {"embedded": EMBEDDED_FOLDER, "organic": EMBEDDED_FOLDER.with_name("organic")}
REFERENCE_REFINEMENT = (
    4  # times finer: the mesh whose volume is taken for exact where no B-rep's is
)


@dataclass(frozen=True)
class MeshPart:
    """A mesh, its finishes, and the volume that it is held against."""

    mesh: Mesh
    finishes: tuple[Appearance, ...]  # that the mesh counts
    reference: Literal["b-rep", "finer mesh"]
    reference_volume_mm3: float


@runtime_checkable
class PartRecipe(Protocol):
    """What a family lists: a `Recipe` for the CAD kernel, or a `ProceduralRecipe` of formulas."""

    id: str
    designation: str
    library: str
    origin: str  # the name of its set
    parameters: dict[str, float | int | str]

    def build_mesh(self) -> MeshPart: ...


Families = Mapping[str, Sequence[PartRecipe]]


def catalogue_folder(name: str) -> Path:
    """The folder of the catalogue `name`; raises BadParams if there is none of that name."""
    if name not in CATALOGUE_FOLDERS:
        raise BadParams(f"--set: no set {name!r}, only {', '.join(CATALOGUE_FOLDERS)}")
    return CATALOGUE_FOLDERS[name]


def load_families(name: str) -> Families:
    """The families of the catalogue `name`; raises SuiteError without the libraries it needs."""
    catalogue_folder(name)
    if name == "organic":
        from industnerf.parts.catalogue.organic import FAMILIES as sculptures

        return sculptures
    try:
        from industnerf.parts.catalogue.families import FAMILIES as recipes
    except ModuleNotFoundError as error:
        raise SuiteError(
            f"drawing parts needs the CAD libraries ({error}): `pip install -e '.[cad]'`"
        ) from error
    return recipes


def find_recipe(name: str, part_id: str) -> tuple[str, PartRecipe]:
    """The family and the drawing of a part of the catalogue `name`; raises BadParams if unknown."""
    for family, recipes in load_families(name).items():
        for recipe in recipes:
            if recipe.id == part_id:
                return family, recipe
    raise BadParams(f"no part {part_id!r} in the set {name!r}; `list --set {name}` names them")
