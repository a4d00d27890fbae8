"""Earlier names of keys, values, files of conf/, flags and commands, for errors that say the new.

Nothing here makes an old name work.  In a key `*` stands for one section: `method.*nerf*` for
industnerf, its variants and nerf.
"""

from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from typing import Any, get_args, get_type_hints

from industnerf.errors import BadParams
from industnerf.schema.readings import Readings

KEYS = {
    "parts.clean": "parts.repair",
    "parts.clean.weld": "parts.repair.weld",
    "parts.clean.speck_area": "parts.repair.small_component_area",
    "parts.clean.speck_size": "parts.repair.small_component_size",
    "parts.clean.specks_at_most": "parts.repair.max_removed_area",
    "parts.clean.orient": "parts.repair.fix_winding",
    "parts.clean.union": "parts.repair.boolean_union",
    "views.light.sway_deg": "views.light.rotation_jitter_deg",
    "views.light.flicker": "views.light.intensity_jitter",
    "views.photo": "views.photorealistic",
    "views.photo.lamp_deg": "views.photorealistic.light_half_angle_deg",
    "views.jitter.aim": "views.jitter.look_at",
    "split.dev_share": "split.dev_fraction",
    "method.*nerf*.tolerance": "method.industnerf_plus.background_tolerance",
    "method.*.tolerance": "method.*.background_tolerance",
    "method.*nerf*.readings.pose": "method.*nerf*.readings.position_encoding",
    "method.*nerf*.readings.frame": "method.*nerf*.readings.encoding_frame",
    "method.*nerf*.readings.views": "method.*nerf*.readings.view_pooling",
    "method.*nerf*.readings.activation": "method.*nerf*.readings.density_activation",
    "method.*nerf*.readings.place": "method.*nerf*.readings.sample_position",
    "method.*nerf*.readings.target": "method.*nerf*.readings.sampling_density",
    "method.*nerf*.readings.weights": "method.*nerf*.readings.interpolation",
    "method.*nerf*.readings.scale": "method.*nerf*.readings.color_scale",
    "method.*nerf*.readings.signal": "method.*nerf*.readings.target_views",
    "method.*nerf*.readings.cloud": "method.*nerf*.readings.extraction",
    "method.*nerf*.readings.samples": "method.*nerf*.readings.sample_reduction",
    "method.*nerf*.grid_points": "method.industnerf_plus.max_grid_points",
    "method.*nerf*.carve": "method.industnerf_plus.silhouette_carving",
    "method.*nerf*.network.use": "method.*nerf*.network.enabled",
    "method.*nerf*.network.features": "method.*nerf*.network.feature_channels",
    "method.*nerf*.network.width": "method.*nerf*.network.encoder_width",
    "method.*nerf*.network.channels": "method.*nerf*.network.encoding_channels",
    "method.*nerf*.network.magnitude": "method.*nerf*.network.encoding_alpha",
    "method.*nerf*.network.base": "method.*nerf*.network.encoding_beta",
    "method.*nerf*.network.hidden": "method.*nerf*.network.hidden_dim",
    "method.*nerf*.network.layers": "method.*nerf*.network.hidden_layers",
    "method.*nerf*.network.every": "method.*nerf*.network.encoder_update_interval",
    "method.*nerf*.network.views": "method.*nerf*.network.encoder_update_views",
    "method.*nerf*.network.rate": "method.*nerf*.network.lr",
    "method.*nerf*.network.straight_rate": "method.*nerf*.network.skip_lr",
    "method.*nerf*.network.encoder_rate": "method.*nerf*.network.encoder_lr",
    "method.*nerf*.network.gain": "method.*nerf*.network.density_scale",
    "method.*nerf*.network.pruned": "method.*nerf*.network.prune_fraction",
    "method.*nerf*.school": "method.industnerf_shared.pretraining",
    "method.*nerf*.school.terms": "method.industnerf_shared.pretraining.epochs",
    "method.*nerf*.residual.use": "method.*nerf*.residual.enabled",
    "method.*nerf*.residual.density_rate": "method.*nerf*.residual.density_lr",
    "method.*nerf*.residual.colour_rate": "method.*nerf*.residual.color_lr",
    "method.*nerf*.softness": "method.*nerf*.beta",
    "method.*nerf*.softness.first": "method.*nerf*.beta.start",
    "method.*nerf*.softness.last": "method.*nerf*.beta.end",
    "method.*nerf*.softness.shown": "method.*nerf*.beta.render",
    "method.*nerf*.relief": "method.industnerf_plus.sdf",
    "method.*nerf*.relief.use": "method.industnerf_plus.sdf.enabled",
    "method.*nerf*.relief.start": "method.industnerf_plus.sdf.init",
    "method.*nerf*.relief.start.use": "method.industnerf_plus.sdf.init.enabled",
    "method.*nerf*.relief.start.deepest": "method.industnerf_plus.sdf.init.initial_max_depth",
    "method.*nerf*.relief.start.threshold": "method.industnerf_plus.sdf.init.color_threshold",
    "method.*nerf*.relief.start.footprint": "method.industnerf_plus.sdf.init.voxel_footprint",
    "method.*nerf*.relief.start.facing": "method.industnerf_plus.sdf.init.min_view_cosine",
    "method.*nerf*.relief.start.outliers": "method.industnerf_plus.sdf.init.outlier_fraction",
    "method.*nerf*.relief.start.views": "method.industnerf_plus.sdf.init.min_views",
    "method.*nerf*.relief.start.sweeps": "method.industnerf_plus.sdf.init.max_sweeps",
    "method.*nerf*.relief.start.least_filled": (
        "method.industnerf_plus.sdf.init.min_silhouette_coverage"
    ),
    "method.*nerf*.relief.rate": "method.industnerf_plus.sdf.lr",
    "method.*nerf*.relief.back": "method.industnerf_plus.sdf.relax_rate",
    "method.*nerf*.relief.back_in_doubt": "method.industnerf_plus.sdf.relax_rate_low_confidence",
    "method.*nerf*.relief.back_within": "method.industnerf_plus.sdf.relax_max_depth",
    "method.*nerf*.relief.slack": "method.industnerf_plus.sdf.max_depth_factor",
    "method.*nerf*.relief.fill_every": "method.industnerf_plus.sdf.median_filter_interval",
    "method.*nerf*.relief.fill_from": "method.industnerf_plus.sdf.median_filter_start",
    "method.*nerf*.initial": "method.*nerf*.density_bias",
    "method.*nerf*.ceiling": "method.*nerf*.max_raw_density",
    "method.*nerf*.rays": "method.*nerf*.rays_per_step",
    "method.*nerf*.step": "method.*nerf*.step_size",
    "method.*nerf*.fine_step": "method.*nerf*.fine_step_size",
    "method.*nerf*.radius": "method.*nerf*.neighbor_radius",
    "method.*nerf*.neighbours": "method.*nerf*.neighbors",
    "method.*nerf*.stop": "method.*nerf*.early_stop_transmittance",
    "method.*nerf*.emptiness": "method.*nerf*.opacity_weight",
    "method.*nerf*.veil": "method.*nerf*.binary_opacity_weight",
    "method.*nerf*.depth": "method.industnerf_depth.depth_weight",
    "method.*nerf*.noise": "method.*nerf*.image_noise",
    "method.*nerf*.least_confidence": "method.*nerf*.min_confidence",
    "method.*nerf*.spacing": "method.*nerf*.surface_spacing",
    "method.*.training.steps": "method.*.training.max_steps",
    "method.*.training.batch": "method.*.training.batch_size",
    "method.*.training.rate": "method.*.training.lr",
    "method.*.training.validation": "method.*.training.val_fraction",
    "method.*.training.validate_every": "method.*.training.val_interval",
    "method.*.augment.colour": "method.*.augment.color_jitter",
    "method.r2n2.divisor": "method.r2n2.channel_divisor",
    "method.r2n2.views": "method.r2n2.max_views",
    "method.atlasnet.frame": "method.atlasnet.output_axes",
    "method.atlasnet.views": "method.atlasnet.train_views",
    "method.atlasnet.width": "method.atlasnet.encoder_width",
    "method.atlasnet.latent": "method.atlasnet.latent_dim",
    "method.atlasnet.hidden": "method.atlasnet.hidden_dim",
    "method.atlasnet.grid": "method.atlasnet.grid_res",
    "method.atlasnet.answers": "method.atlasnet.eval_views",
    "method.occupancy.frame": "method.occupancy.query_axes",
    "method.occupancy.output_axes": "method.occupancy.query_axes",
    "method.occupancy.views": "method.occupancy.train_views",
    "method.occupancy.code": "method.occupancy.latent_dim",
    "method.occupancy.blocks": "method.occupancy.decoder_blocks",
    "method.occupancy.pool": "method.occupancy.points_per_part",
    "method.occupancy.queries": "method.occupancy.points_subsample",
    "method.occupancy.answers": "method.occupancy.eval_views",
    "method.occupancy.cells": "method.occupancy.resolution_0",
    "method.occupancy.subdivisions": "method.occupancy.upsampling_steps",
    "method.carve.threshold": "method.carve.color_threshold",
    "method.carve.footprint": "method.carve.voxel_footprint",
    "method.carve.facing": "method.carve.min_view_cosine",
    "method.carve.outliers": "method.carve.outlier_fraction",
    "method.carve.views": "method.carve.min_views",
    "method.carve.sweeps": "method.carve.max_sweeps",
    "method.carve.least_filled": "method.carve.min_silhouette_coverage",
    "evaluate.dense": "evaluate.dense_samples",
    "evaluate.cap": "evaluate.max_points",
    "evaluate.rig": "evaluate.visibility_views",
    "evaluate.rig_radius": "evaluate.visibility_radius",
    "evaluate.hidden": "evaluate.occlusion_margin",
    "evaluate.fscore": "evaluate.fscore_threshold",
    "report.resamples": "report.bootstrap_resamples",
    "report.interval": "report.confidence_level",
    "report.sheet_parts": "report.contact_sheet_parts",
}
# New key -> old value -> new value.
VALUES = {
    "method.atlasnet.output_axes": {"view": "picture"},
    "method.occupancy.query_axes": {"view": "picture"},
    "method.*nerf*.readings.encoding_frame": {"pose": "camera_center"},
    "method.*nerf*.readings.view_pooling": {
        "confident": "confidence_weighted",
        "surest": "argmax_confidence",
    },
    "method.*nerf*.readings.density_activation": {"distance": "sdf", "cut_exp": "truncated_exp"},
    "method.*nerf*.readings.sample_position": {"centre": "center"},
    "method.*nerf*.readings.sampling_density": {"sigma": "density", "visible": "visible_density"},
    "method.*nerf*.readings.interpolation": {"tapered": "modified_shepard", "tent": "trilinear"},
    "method.*nerf*.readings.target_views": {"sources": "same_as_source", "left_out": "disjoint"},
    "method.*nerf*.readings.extraction": {
        "confident": "confident_points",
        "surface": "surface_points",
        "fused": "tsdf_fusion",
    },
    "method.*nerf*.readings.encoder": {"shared": "pretrained"},
    "method.*nerf*.refine": {"sampled": "inverse_transform", "divided": "subdivide"},
    "views.rig": {"rings": "turntable"},
    "views.background": {"grey": "gray"},
    "views.shading": {"photo": "photorealistic"},
}
GROUPS = {"without": "ablation"}  # folders of conf/
ABLATIONS = {
    "falling_back": "relaxation",
    "filling": "median_filter",
    "relief": "sdf",
    "shallow": "relax_max_depth",
    "softness": "beta_schedule",
}
FLAGS = {  # of industnerf.reconstruct
    "--all": "--all-frames",
    "--every": "--all-frames",
    "--fresh": "--no-resume",
    "--show": "--print-config",
    "--centre": "--center",
}
STAGES = (
    "solids",
    "parts",
    "views",
    "split",
    "truth",
    "train",
    "reconstruct",
    "evaluate",
    "report",
)
COMMANDS = {  # python -m ...
    "pipeline.retable": "pipeline.rebuild_tables",
    "pipeline.spread": "pipeline.seed_variance",
    "pipeline.effects": "pipeline.ablation_effects",
    "pipeline.sweeps": "pipeline.sweep_docs",
    **{f"pipeline.{stage}": f"pipeline.stages.{stage}" for stage in STAGES},
}


def new_key(key: str) -> str | None:
    """Today's name of the dotted `key`; None if it has not another one."""
    for old, new in KEYS.items():
        if _matches(old, key):
            names, sections = new.split("."), key.split(".")
            return ".".join(
                section if "*" in name else name
                for name, section in zip(names, sections, strict=True)
            )
    section, dot, name = key.rpartition(".")
    return f"{renamed}.{name}" if dot and (renamed := new_key(section)) else None


def new_value(key: str, value: object) -> str | None:
    """Today's name of `value` where `key` has it; None if it has not another one."""
    values = next((values for new, values in VALUES.items() if _matches(new, key)), {})
    return values.get(value) if isinstance(value, str) else None


def new_choice(group: str, choice: str) -> str | None:
    """Today's name of a file in the folder `group` of conf/; None if it has not another one."""
    if group == "ablation":
        return ABLATIONS.get(choice)
    name, dash, value = choice.partition("-")
    if group != "reading" or not dash:
        return None
    old_key = f"method.industnerf.readings.{name}"
    key = new_key(old_key) or old_key
    field, renamed_value = key.rpartition(".")[2], new_value(key, value) or value
    if renamed_value not in get_args(get_type_hints(Readings).get(field)):
        return None
    renamed = f"{field}-{renamed_value}"
    return renamed if renamed != choice else None


def check_overrides(overrides: Iterable[tuple[str, object]]) -> None:
    """Raises BadParams that says the new name if a key or a choice of `overrides` has one.

    Values of keys are checked where their types are.  A choice may be several, with commas.
    """
    for key, value in overrides:
        group = GROUPS.get(key, key)
        choices = str(value).split(",") if group in ("reading", "ablation") else []
        renamed = {choice: new_choice(group, choice.strip()) for choice in choices}
        if group != key or any(renamed.values()):
            new_values = ",".join(renamed[choice] or choice for choice in choices)
            raise BadParams(f"{key}={value} is now {group}={new_values}")
        if new := new_key(key):
            raise BadParams(f"{key} is now {new}")


def flatten_preset(values: Mapping[str, Any]) -> list[tuple[str, object]]:
    """Dotted keys and values of a preset, what it sweeps included."""
    flattened: list[tuple[str, object]] = []
    for key, value in values.items():
        if isinstance(value, Mapping):
            flattened += [(f"{key}.{name}", leaf) for name, leaf in flatten_preset(value)]
        else:
            flattened.append((key, value))
    return [(key.removeprefix("hydra.sweeper.params."), value) for key, value in flattened]


def _matches(pattern: str, key: str) -> bool:
    names, sections = pattern.split("."), key.split(".")
    return len(names) == len(sections) and all(map(fnmatchcase, sections, names))
