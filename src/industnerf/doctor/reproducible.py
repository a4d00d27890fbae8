"""Does this machine give the published bytes: few steps of each method, on a tiny part.

Digests are of `results/reproducible.json`, with the versions and the processor that gave them.
Whoever changes what a method computes writes them anew: `python -m industnerf.doctor.reproducible`.
"""

import dataclasses
import hashlib
import json
import tempfile
from collections.abc import Iterator
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from industnerf import config, processor
from industnerf.capture.render import render_part
from industnerf.cli import exit_with_message
from industnerf.code_hash import library_versions
from industnerf.content import content_digest
from industnerf.doctor.findings import Finding
from industnerf.doctor.operations import OPERATIONS
from industnerf.doctor.project_paths import ProjectPaths
from industnerf.methods import load_method
from industnerf.methods.base import Example, Scope
from industnerf.methods.run_method import fit_method, reconstruct_part
from industnerf.parts.catalogue.sources import embedded_parts
from industnerf.parts.procedural import ALL_KINDS, procedural_solid
from industnerf.parts.procedural import digest as solids_digest
from industnerf.schema import Params
from industnerf.torch_kernels import use_reproducible_kernels

DIGESTS = Path("results/reproducible.json")
PRESET = Path("conf/experiment/smoke.yaml")
METHODS = (
    *("industnerf", "industnerf_plus", "nerf", "r2n2", "atlasnet", "occupancy"),
    *("hull_rgb", "carve", "tsdf"),
)
TRAINING_STEPS = 20  # of a network
COMPUTING_MODULES = ("industnerf.capture.render", "industnerf.parts.procedural.solid")
PROCEDURAL_SOLIDS = 100  # of seed 0, of all kinds


def check(paths: ProjectPaths) -> list[Finding]:
    """One finding: that all bytes are the published ones, or which kinds of result are not."""
    published_path = paths.root / DIGESTS
    published = json.loads(published_path.read_text(encoding="utf-8"))
    here = f"{processor.model()}, {processor.isa()}"
    different = [
        name
        for name, digest in compute_digests(paths.root)
        if published["digests"].get(name) != digest
    ]
    if not different:
        return [Finding(published_path, f"this machine gives the published bytes ({here})")]
    versions = [
        f"{name} is {version} and was {published['versions'].get(name)}"
        for name, version in installed_versions().items()
        if version != published["versions"].get(name)
    ]
    published_with = f"{published['processor']}, {published['isa']}"
    message = (
        f"this machine ({here}) gives other bytes than the published ones ({published_with}) of "
        f"{'; '.join(different)}"
    )
    if versions:
        message += f"; versions differ: {', '.join(versions)}"
    return [Finding(published_path, message, is_unfixable=True)]


def compute_digests(root: Path) -> Iterator[tuple[str, str]]:
    """Name and SHA-256 of each kind of result, one at a time: operations, solids, methods."""
    use_reproducible_kernels()
    for name, operation in OPERATIONS.items():
        yield name, _digest_arrays(operation())
    yield "procedural solids", procedural_digest()
    params = config.load_preset(root / PRESET, root / config.PARAMS)
    with tempfile.TemporaryDirectory() as folder:
        yield from _method_digests(params, root / params.parts.path, Path(folder))


def procedural_digest() -> str:
    """SHA-256 of the first procedural solids."""
    return solids_digest([procedural_solid(0, i, ALL_KINDS) for i in range(PROCEDURAL_SOLIDS)])


def _method_digests(params: Params, catalogue: Path, folder: Path) -> Iterator[tuple[str, str]]:
    """The networks learn from the first part; every method reconstructs the last."""
    parts, views = folder / "parts", folder / "views"
    for part in embedded_parts(catalogue, params.parts.select):
        (parts / part.part_id).mkdir(parents=True)
        (views / part.part_id).mkdir(parents=True)
        part.make(parts / part.part_id)
        part_dir = parts / part.part_id
        render_part(part_dir, views / part.part_id, params.views, params.seed)
    yield "parts", content_digest([parts])
    yield "views", content_digest([views])
    learned_id, *_, target_id = sorted(path.name for path in parts.iterdir())
    for name in METHODS:
        method, settings = load_method(name), getattr(params.method, name)
        state, cloud = None, folder / name / "cloud"
        cloud.mkdir(parents=True)
        if method.scope == Scope.DATASET:
            training = dataclasses.replace(settings.training, max_steps=TRAINING_STEPS)
            settings = dataclasses.replace(settings, training=training)
            folders = parts / learned_id, views / learned_id
            example = Example(learned_id, learned_id, *folders, method.inputs)
            state, scratch = folder / name / "state", folder / name / "scratch"
            state.mkdir()
            scratch.mkdir()
            fit_method(
                method, [example], state, settings=settings, seed=params.seed, scratch=scratch
            )
        reconstruct = partial(reconstruct_part, settings=settings, seed=params.seed)
        reconstruct(method, parts / target_id, views / target_id, state, cloud)
        yield name, content_digest([cloud])


def _digest_arrays(arrays: list[np.ndarray]) -> str:
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def installed_versions() -> dict[str, str]:
    """The versions of what computes, without the tag of a build."""
    modules = (*COMPUTING_MODULES, *(load_method(name).module for name in METHODS))
    versions = library_versions(modules)
    # one extension module without Python files, which `library_versions` does not see
    versions = {**versions, "manifold3d": version("manifold3d")}
    return {name: text.partition("+")[0] for name, text in versions.items()}


def write_digests(root: Path) -> None:
    """Write the digests of this machine, to be committed."""
    digests: dict[str, Any] = {
        "processor": processor.model(),
        "isa": processor.isa(),
        "versions": installed_versions(),
        "digests": dict(compute_digests(root)),
    }
    (root / DIGESTS).write_text(json.dumps(digests, indent=2) + "\n", encoding="utf-8")
    print(f"wrote {DIGESTS}: {len(digests['digests'])} digests")


if __name__ == "__main__":
    exit_with_message(partial(write_digests, Path.cwd()))
