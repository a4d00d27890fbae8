"""Reconstruction methods, by name.  Only `industnerf_plus` imports another, `industnerf`."""

from importlib import import_module

from industnerf.errors import BadParams
from industnerf.methods.base import Method

MODULES = {
    "industnerf": "industnerf.methods.industnerf",
    "industnerf_plus": "industnerf.methods.industnerf_plus",
    "industnerf_depth": "industnerf.methods.industnerf",
    "industnerf_shared": "industnerf.methods.industnerf",
    "nerf": "industnerf.methods.industnerf",
    "r2n2": "industnerf.methods.r2n2",
    "atlasnet": "industnerf.methods.atlasnet",
    "occupancy": "industnerf.methods.occupancy",
    "hull": "industnerf.methods.hull",
    "hull_rgb": "industnerf.methods.hull",
    "carve": "industnerf.methods.carve",
    "tsdf": "industnerf.methods.tsdf",
    "retrieval": "industnerf.methods.retrieval",
    "retrieval_procedural": "industnerf.methods.retrieval",
    "mean_shape": "industnerf.methods.mean_shape",
    "mean_shape_procedural": "industnerf.methods.mean_shape",
    "ball": "industnerf.methods.trivial_baselines",
    "box": "industnerf.methods.trivial_baselines",
    "oracle": "industnerf.methods.trivial_baselines",
}


def load_method(name: str) -> Method:
    """The method called `name`; raises BadParams that lists the known ones."""
    if name not in MODULES:
        raise BadParams(f"methods: {name!r} is unknown, known are {', '.join(MODULES)}")
    return import_module(MODULES[name]).METHODS[name]
