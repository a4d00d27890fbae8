"""What every method is: two functions, a scope, and the inputs that it declares.

    fit(examples, settings, seed, scratch) -> ModelState      scope `dataset` only
    reconstruct(inputs, settings, state, seed) -> Reconstruction

A method is given its cameras and what it declares, and nothing else.  It may return more than
points: renderings from the held-out cameras, confidence, the history of its loss.
What is learned from other parts is learned from `Example`s, and returned as `ModelState`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Float32, Int, Int32, Int64, UInt8

from industnerf.artifacts.candidates import Candidates
from industnerf.artifacts.history import History
from industnerf.artifacts.part import Mesh, load_mesh
from industnerf.artifacts.renderings import Renderings
from industnerf.artifacts.state import ModelState
from industnerf.artifacts.views import load_views
from industnerf.errors import UndeclaredInput
from industnerf.geometry.bounding_cube import BoundingCube
from industnerf.geometry.cameras import Cameras, nested_view_order, nested_view_subset
from industnerf.learning import targets
from industnerf.learning.views import picture_frames, resize_images


class Input(StrEnum):
    """What a method may ask for beside its cameras."""

    RGB = "rgb"
    BACKGROUND = "background"  # the color behind the part
    MASK = "mask"
    DEPTH = "depth"
    PART_FRAME = "frame"  # axes, center and longest edge of the part
    OTHER_MESHES = "other meshes"
    PROCEDURAL_SOLIDS = "procedural solids"  # and weights that were pretrained on them
    OWN_MESH = "own mesh"


# of networks that learn from other parts
NETWORK_INPUTS = frozenset(
    {
        Input.RGB,
        Input.BACKGROUND,
        Input.PART_FRAME,
        Input.OTHER_MESHES,
        Input.PROCEDURAL_SOLIDS,
    }
)


class Scope(StrEnum):
    """What a method learns from."""

    PART = "part"  # this part's own images
    DATASET = "dataset"  # other parts


class Role(StrEnum):
    """How to read a method's row."""

    METHOD = "method"
    NULL = "null"  # sees no photograph of the part: what any method must beat
    BOUND = "bound"  # is given the answer: a bound on what a method can reach


@dataclass(frozen=True)
class Example:
    """A part to learn from, with what the method declares; files are read on demand."""

    part_id: str
    group: str  # parts of one group are validated on together: its family, or itself
    part: Path
    views: Path
    inputs: frozenset[Input]

    @property
    def mesh(self) -> tuple[Float[np.ndarray, "n 3"], Int32[np.ndarray, "m 3"]]:
        """Vertices in the unit cube of the part's `BoundingCube`, and faces."""
        self._refuse_undeclared(Input.OTHER_MESHES)
        mesh = load_mesh(self.part)
        return BoundingCube.of(mesh.vertices).to_unit(mesh.vertices), mesh.faces

    def rgb(self, px: int, count: int) -> UInt8[np.ndarray, "views {px} {px} 3"]:
        """At most `count` of the training views, in nested order, scaled to `px` a side."""
        self._refuse_undeclared(Input.RGB)
        views = load_views(self.views)
        return resize_images(views.rgb(views.train_indices[self.view_indices(count)]), px)

    def background(self, count: int) -> Float[np.ndarray, "views 3"]:
        """The color behind the part in each of the views that `rgb` takes."""
        self._refuse_undeclared(Input.BACKGROUND)
        views = load_views(self.views)
        return views.background[views.train_indices[self.view_indices(count)]]

    def picture_frames(self, count: int) -> Float[np.ndarray, "views 3 3"]:
        """From the unit cube to the axes of each of the pictures that `rgb` takes."""
        self._refuse_undeclared(Input.OTHER_MESHES)
        views = load_views(self.views)
        cameras = views.cameras[views.train_indices[self.view_indices(count)]]
        return picture_frames(cameras, BoundingCube.of(load_mesh(self.part).vertices))

    def view_indices(self, count: int) -> Int64[np.ndarray, "_"]:
        """Which of the training views `rgb` takes."""
        self._refuse_undeclared(Input.RGB)
        views = load_views(self.views)
        centers = views.cameras.centers[views.train_indices]
        return nested_view_order(centers, min(count, len(centers)))

    def filled_shares(self, size: int = targets.VOXELS) -> UInt8[np.ndarray, "n n n"]:
        """How much of each voxel is solid; 255 is all of it."""
        return targets.filled_shares(*self.mesh, size)

    def occupancy_pool(self, count: int, rng: np.random.Generator) -> targets.OccupancyPool:
        """`count` points of the padded unit cube with known occupancy."""
        return targets.sample_occupancy(*self.mesh, count, rng)

    def surface_pool(self, rng: np.random.Generator) -> Float32[np.ndarray, "pool 3"]:
        """Area-uniform points of the surface."""
        return targets.surface_points(*self.mesh, targets.SURFACE_POOL, rng)

    def _refuse_undeclared(self, name: Input) -> None:
        if name not in self.inputs:
            raise UndeclaredInput(
                f"the method learns from {name.value!r}, but declares only {sorted(self.inputs)}"
            )


@dataclass(frozen=True)
class MethodInputs:
    """The cameras of one part, and the declared inputs, one entry a training view."""

    method: str
    cameras: Cameras  # of the training views, as the calibration has them
    held_out: Cameras  # exact, poses only: from where to re-render
    loaded: Mapping[Input, Any]
    # which of the training views these are; None: all
    view_indices: Int64[np.ndarray, "n"] | None = None

    @property
    def rgb(self) -> UInt8[np.ndarray, "n h w 3"]:
        return self._declared(Input.RGB)

    @property
    def background(self) -> Float[np.ndarray, "n 3"]:
        """One color a view, in [0, 1]."""
        return self._declared(Input.BACKGROUND)

    @property
    def mask(self) -> Bool[np.ndarray, "n h w"]:
        return self._declared(Input.MASK)

    @property
    def depth_mm(self) -> Float32[np.ndarray, "n h w"]:
        return self._declared(Input.DEPTH)

    @property
    def part_frame(self) -> BoundingCube:
        return self._declared(Input.PART_FRAME)

    @property
    def own_mesh(self) -> Mesh:
        return self._declared(Input.OWN_MESH)

    def _declared(self, name: Input) -> Any:
        if name not in self.loaded:
            raise UndeclaredInput(
                f"method {self.method!r} reaches for {name.value!r}, but declares only "
                f"{sorted(self.loaded)}; add it to the method's `inputs`."
            )
        return self.loaded[name]


@dataclass(frozen=True)
class Reconstruction:
    """What a method returns; all but the points may be left out."""

    points_mm: Float[np.ndarray, "n 3"]
    colors: UInt8[np.ndarray, "n 3"] | None = None
    confidence: Float[np.ndarray, "n"] | None = None
    num_parameters: int = 0
    steps: int = 0
    view: Int[np.ndarray, "n"] | None = None  # the training view that weighs most in it; -1 unknown
    render: Callable[[], Renderings] | None = None  # from `MethodInputs.held_out`, when called
    candidates: Candidates | None = None  # before any filter
    history: History | None = None
    # Further predictions of a method that sees one view at a time: its score is the mean over all.
    extra_clouds_mm: tuple[Float[np.ndarray, "_ 3"], ...] = ()
    warnings: tuple[str, ...] = ()  # on what it was given, for whoever reads the result


@dataclass(frozen=True)
class Method:
    """A declared algorithm.  `reconstruct(inputs, settings, state, seed)` does the work."""

    name: str
    scope: Scope
    inputs: frozenset[Input]
    reconstruct: Callable[[MethodInputs, Any, Any, int], Reconstruction]
    fit: Callable[..., ModelState] | None = None  # one more argument with PROCEDURAL_SOLIDS: Prior
    role: Role = Role.METHOD
    is_stochastic: bool = False  # another seed of `reconstruct` gives another cloud

    @property
    def module(self) -> str:
        """Where its code is: results depend on what that module imports."""
        return self.reconstruct.__module__


def load_inputs(method: Method, part: Path, views: Path, num_views: int = 0) -> MethodInputs:
    """Read from disk what `method` declares of one part, and nothing else.

    Of its training views `num_views`, evenly spread and among those of any larger number; 0: all.
    """
    loaded_views = load_views(views)
    cameras, train, view_indices = loaded_views.cameras, loaded_views.train_indices, None
    if num_views:
        view_indices = nested_view_subset(cameras[train].centers, num_views)
        train = train[view_indices]
    readers: dict[Input, Callable[[], Any]] = {
        Input.RGB: lambda: loaded_views.rgb(train),
        Input.BACKGROUND: lambda: loaded_views.background[train],
        Input.MASK: lambda: loaded_views.mask(train),
        Input.DEPTH: lambda: loaded_views.depth_mm(train),
        Input.PART_FRAME: lambda: BoundingCube.of(load_mesh(part).vertices),
        Input.OWN_MESH: lambda: load_mesh(part),
    }
    loaded = {name: readers[name]() for name in sorted(method.inputs) if name in readers}
    return MethodInputs(
        method.name, cameras[train], cameras[loaded_views.held_out], loaded, view_indices
    )
