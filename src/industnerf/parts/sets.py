"""The baked sets: where each lies, and who draws it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Protocol, runtime_checkable

from industnerf.errors import BadParams, SuiteError
from industnerf.parts.catalogue import EMBEDDED
from industnerf.parts.meshed import Meshed

FOLDERS = {"embedded": EMBEDDED, "organic": EMBEDDED.with_name("organic")}


@runtime_checkable
class Drawable(Protocol):
    """What a family lists: a `Recipe` for the CAD kernel, or a `Sculpture` of formulas."""

    id: str
    designation: str
    library: str
    origin: str  # the name of its set
    parameters: dict[str, float | int | str]

    def meshed(self) -> Meshed: ...


Families = Mapping[str, Sequence[Drawable]]


def folder_of(name: str) -> Path:
    """Where the set `name` is baked; raises BadParams if there is none of that name."""
    if name not in FOLDERS:
        raise BadParams(f"--set: no set {name!r}, only {', '.join(FOLDERS)}")
    return FOLDERS[name]


def families_of(name: str) -> Families:
    """The families of the set `name`; raises SuiteError if what draws them is not installed."""
    folder_of(name)
    if name == "organic":
        from industnerf.parts.organic import FAMILIES as sculptures

        return sculptures
    try:
        from industnerf.parts.families import FAMILIES as recipes
    except ModuleNotFoundError as error:
        raise SuiteError(
            f"drawing parts needs the CAD libraries ({error}): `pip install -e '.[cad]'`"
        ) from error
    return recipes


def drawable(name: str, part_id: str) -> tuple[str, Drawable]:
    """The family and the drawing of a part of the set `name`; raises BadParams if unknown."""
    for family, listed in families_of(name).items():
        for each in listed:
            if each.id == part_id:
                return family, each
    raise BadParams(f"no part {part_id!r} in the set {name!r}; `list --set {name}` names them")
