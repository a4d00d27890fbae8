"""Bring pretrained weights under version control, for `pretrain.weights: shipped`.

    dvc repro pretrain                    with pretrain.weights: trained in params.yaml
    python -m pipeline.publish_weights [METHOD ...]       all three, where none is named

Reads data/weights, and writes data/pretrained/<method>: the weights as 16-bit floats, the curves of
their losses, and card.json, which says how they were made.
"""

import hashlib
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from industnerf import processor
from industnerf.artifacts.files import write_json
from industnerf.artifacts.state import ModelState
from industnerf.cli import run_command
from industnerf.config import PARAMS, load_params
from industnerf.errors import BadParams
from industnerf.methods.run_method import WEIGHTS
from industnerf.report.publish.provenance import build_provenance

TRAINED, SHIPPED = Path("data/weights"), Path("data/pretrained")
NETWORKS = ("r2n2", "atlasnet", "occupancy")
COMMAND = "dvc repro pretrain"


def main(*methods: str) -> None:
    if unknown := set(methods) - set(NETWORKS):
        raise BadParams(f"no network {', '.join(sorted(unknown))}: there are {', '.join(NETWORKS)}")
    params = load_params(PARAMS)
    if params.pretrain.weights != "trained":
        raise BadParams(
            f"pretrain.weights is {params.pretrain.weights}: {TRAINED} has no new weights; set it "
            f"to trained, and run `{COMMAND}`"
        )
    for name in methods or NETWORKS:
        state = to_half(ModelState.load(TRAINED / name / WEIGHTS))
        target = SHIPPED / name
        target.mkdir(parents=True, exist_ok=True)
        state.save(target)
        settings = getattr(params.method, name)
        card = {
            "seed": params.seed,
            "procedural": asdict(params.procedural),
            "settings": asdict(replace(settings, training=settings.pretraining)),
            "sha256": arrays_digest(state.arrays),
            "processor": processor.model(),
            "isa": processor.isa(),
        }
        write_json(target / "card.json", build_provenance(COMMAND) | card)
        size = sum(path.stat().st_size for path in target.rglob("*") if path.is_file())
        print(f"wrote {target}: {state.num_parameters} parameters, {size / 1e6:.1f} MB")


def to_half(state: ModelState) -> ModelState:
    """`state` with 16-bit floats: half the size, at a loss far below that of training anew."""
    arrays = {
        name: array.astype(np.float16) if array.dtype == np.float32 else array
        for name, array in state.arrays.items()
    }
    return replace(state, arrays=arrays)


def arrays_digest(arrays: dict[str, np.ndarray]) -> str:
    """SHA-256 of all arrays, in the order of their names."""
    digest = hashlib.sha256()
    for name in sorted(arrays):
        digest.update(name.encode() + np.ascontiguousarray(arrays[name]).tobytes())
    return digest.hexdigest()


if __name__ == "__main__":
    run_command(main)
