"""The kinds of procedural solids, by name."""

from collections.abc import Callable

from manifold3d import Manifold

from industnerf.parts.procedural import (
    combined_kinds,
    extruded_kinds,
    resembling_kinds,
    sprawling_kinds,
    turned_kinds,
    walled_kinds,
)
from industnerf.parts.procedural.sampler import Sampler

Kind = Callable[[Sampler], Manifold]

_ABSTRACT: tuple[Kind, ...] = (
    turned_kinds.turned_steps,
    turned_kinds.turned_curve,
    turned_kinds.turned_shell,
    turned_kinds.turned_ring,
    turned_kinds.turned_sector,
    turned_kinds.grooved_body,
    turned_kinds.helical_body,
    extruded_kinds.bored_prism,
    extruded_kinds.eased_block,
    extruded_kinds.lobed_prism,
    extruded_kinds.twisted_prism,
    extruded_kinds.stacked_prisms,
    extruded_kinds.crossed_prisms,
    extruded_kinds.intersected_prisms,
    extruded_kinds.folded_sheet,
    extruded_kinds.corrugated_sheet,
    extruded_kinds.open_frame,
    combined_kinds.combined,
    combined_kinds.mirrored,
    combined_kinds.block_steps,
    combined_kinds.polar_pattern,
    combined_kinds.faceted_block,
    combined_kinds.hulled_lumps,
    combined_kinds.lofted_stack,
    walled_kinds.pocketed_plate,
    walled_kinds.pocketed_block,
    walled_kinds.ribbed_plate,
    walled_kinds.fin_field,
    walled_kinds.fins_around,
    walled_kinds.walled_tray,
    walled_kinds.windowed_shell,
    walled_kinds.perforated_panel,
    walled_kinds.terraces,
    walled_kinds.boss_cluster,
    walled_kinds.stacked_plates,
    sprawling_kinds.bar_lattice,
    sprawling_kinds.bar_walk,
    sprawling_kinds.swept_tube,
    sprawling_kinds.swept_bar,
    sprawling_kinds.armed_hub,
    sprawling_kinds.armed_core,
)
DEFAULT_KINDS: tuple[str, ...] = tuple(kind.__name__ for kind in _ABSTRACT)
"""Features combined at random: none of these imitates a family of the study."""

_RESEMBLING: dict[Kind, str] = {
    resembling_kinds.ball_bearing: "bearings",
    resembling_kinds.angle_bracket: "brackets_structure",
    resembling_kinds.spoked_wheel: "drives_wheels",
    resembling_kinds.crank: "engine",
    resembling_kinds.flange: "flanges",
    resembling_kinds.gear: "gears",
    resembling_kinds.motor_housing: "housings_motors",
    resembling_kinds.spring: "linear_springs",
    resembling_kinds.nut: "nuts_washers_inserts",
    resembling_kinds.elbow: "pipe_fittings",
    resembling_kinds.fan: "rotors",
    resembling_kinds.bolt: "screws",
    resembling_kinds.stepped_shaft: "shafts_couplings",
    resembling_kinds.heat_sink: "thermal",
    resembling_kinds.end_mill: "tooling_misc",
    resembling_kinds.valve_body: "valves_fluid",
}
RESEMBLING_KINDS: dict[str, str] = {kind.__name__: name for kind, name in _RESEMBLING.items()}
"""Kinds that imitate a family of the study -> that family, with which they are held out."""

ALL_KINDS: tuple[str, ...] = (*DEFAULT_KINDS, *RESEMBLING_KINDS)
KINDS: dict[str, Kind] = {kind.__name__: kind for kind in (*_ABSTRACT, *_RESEMBLING)}
