"""The command line of `python -m industnerf.reconstruct`."""

import argparse
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from industnerf.renamed import FLAGS

METHODS = ("industnerf", "industnerf_plus")
MESH_SUFFIXES = (".stl", ".ply", ".obj")
COLORS = {
    "white": (1.0, 1.0, 1.0),
    "gray": (128 / 255, 128 / 255, 128 / 255),
    "black": (0.0, 0.0, 0.0),
}
FloatTriple = tuple[float, float, float]


@dataclass(frozen=True)
class Options:
    """What was asked for; every path to write to is settled."""

    cameras: Path | None  # None: found from the photographs, by --sfm
    images: Path | None  # None: beside the cameras
    sfm: bool
    out: Path
    npz: Path | None
    mesh: Path | None
    mesh_pieces: int | None  # None: all
    checkpoint: Path
    preview: Path
    has_explicit_preview: bool  # by the user, so that what stands there may be anything
    method: str
    params: Path | None
    overrides: tuple[str, ...]
    all_frames: bool
    exclude: tuple[str, ...]
    strict: bool
    ignore_masks: bool
    undo_transform: bool
    scale: tuple[str, str, float] | None
    background: FloatTriple | None
    max_size: int
    center: FloatTriple | None
    radius: float | None
    checkpoint_every: float
    preview_every: float
    print_config: bool
    no_resume: bool
    force: bool


def parse_args(arguments: Sequence[str], description: str) -> Options:
    """The options in `arguments`; ends the process with code 2 and a sentence if they are wrong."""
    parser = argparse.ArgumentParser(
        prog="python -m industnerf.reconstruct",
        description=description,
        allow_abbrev=False,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    # argparse's own takes -2.3e-05 for an option
    parser._negative_number_matcher = re.compile(r"-\.?\d")
    _add_inputs(parser)
    _add_outputs(parser)
    _add_settings(parser)
    for flag in FLAGS.keys() & set(arguments):
        parser.error(f"{flag} is now {FLAGS[flag]}")
    args = vars(parser.parse_args(arguments))
    out, cameras, npz, preview, center = (
        args.pop(key) for key in ("out", "cameras", "npz", "preview", "center")
    )
    if out.suffix.lower() != ".ply":
        parser.error(f"--out {out}: must end in .ply")
    mesh = args["mesh"]
    if mesh is not None and mesh.suffix.lower() not in MESH_SUFFIXES:
        parser.error(
            f"--mesh {mesh}: must end in {', '.join(MESH_SUFFIXES[:-1])} or {MESH_SUFFIXES[-1]}"
        )
    if center is not None and args["radius"] is None:
        parser.error("--center needs --radius beside it")
    if args["sfm"] == (cameras is not None):
        parser.error("either --cameras, or --sfm to find the cameras from the photographs alone")
    if args["sfm"] and args["images"] is None:
        parser.error("--sfm needs --images DIR, the folder of the photographs")
    if args["mesh_pieces"] and mesh is None:
        parser.error("--mesh-pieces needs --mesh beside it")
    try:
        scale = args["scale"] and (*args["scale"][:2], _positive_float(args["scale"][2]))
    except argparse.ArgumentTypeError as error:
        parser.error(f"argument --scale: {error}")
    return Options(
        cameras=cameras,
        out=out,
        npz=out.with_suffix(".npz") if npz else None,
        checkpoint=args.pop("checkpoint") or Path(f"{out}.checkpoint"),
        preview=preview or Path(f"{out}.preview.png"),
        has_explicit_preview=preview is not None,
        overrides=tuple(args.pop("overrides")),
        exclude=tuple(args.pop("exclude")),
        scale=args.pop("scale") and scale,
        center=center and tuple(center),
        **args,
    )


def _add_inputs(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("what to work on")
    group.add_argument(
        "--cameras",
        type=Path,
        metavar="FILE|DIR",
        help="transforms.json, a COLMAP model (such as sparse/0), sdfstudio's meta_data.json, or a "
        "zip archive of one of them with its photographs",
    )
    group.add_argument("--images", type=Path, metavar="DIR", help="default: beside the cameras")
    group.add_argument(
        "--sfm",
        action="store_true",
        help="find the cameras from the photographs in --images, by pycolmap; kept in OUT.sfm",
    )
    group.add_argument(
        "--scale",
        nargs=3,
        metavar=("A", "B", "MM"),
        help="make it mm: the distance of A and B, each x,y,z or a photograph, whose camera is "
        "meant; --center and --radius are in mm then",
    )
    group.add_argument(
        "--exclude",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME",
        help="leave out these photographs",
    )
    group.add_argument(
        "--strict", action="store_true", help="refuse if a photograph or a mask is missing"
    )
    group.add_argument(
        "--ignore-masks", action="store_true", help="do without the masks that frames name"
    )
    group.add_argument(
        "--undo-transform",
        action="store_true",
        help="go back to the frame before applied_transform, applied_scale or worldtogt",
    )
    group.add_argument(
        "--all-frames", action="store_true", help="every frame, not train_filenames alone"
    )
    group.add_argument(
        "--background",
        type=_color,
        metavar="COLOR",
        help="behind the part: white, gray, black or #rrggbb; is learned if not given; shows where "
        "a photograph is see-through or masked (default: a color that the part has not)",
    )
    group.add_argument(
        "--max-size",
        type=_int_at_least(16),
        default=512,
        metavar="PX",
        help="reduce photographs to this long edge (512)",
    )
    group.add_argument(
        "--center",
        type=_finite_float,
        nargs=3,
        metavar=("X", "Y", "Z"),
        help="of the region of interest, in the cameras' unit (default: what all look at)",
    )
    group.add_argument("--radius", type=_positive_float, metavar="R", help="of the same")


def _add_outputs(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("what to write")
    group.add_argument("--out", required=True, type=Path, metavar="cloud.ply")
    group.add_argument(
        "--mesh",
        type=Path,
        metavar="surface.stl",
        help="the surface as triangles, closed: .stl, .ply or .obj",
    )
    group.add_argument(
        "--mesh-pieces",
        type=_int_at_least(1),
        metavar="N",
        help="keep the N largest pieces of the mesh (default: all)",
    )
    group.add_argument("--npz", action="store_true", help="the same as .npz beside it")
    group.add_argument("--force", action="store_true", help="overwrite what is there")
    group.add_argument("--checkpoint", type=Path, metavar="FILE", help="default: OUT.checkpoint")
    group.add_argument(
        "--checkpoint-every",
        type=_non_negative_float,
        default=30.0,
        metavar="S",
        help="seconds (30); 0: only on Ctrl-C",
    )
    group.add_argument("--no-resume", action="store_true", help="drop a checkpoint that is there")
    group.add_argument(
        "--preview",
        type=Path,
        metavar="FILE.png",
        help="a photograph | its re-rendering (default: OUT.preview.png)",
    )
    group.add_argument(
        "--preview-every",
        type=_non_negative_float,
        default=20.0,
        metavar="S",
        help="seconds (20); 0: no preview",
    )


def _add_settings(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("how")
    group.add_argument(
        "--method", choices=METHODS, default=METHODS[0], help=f"default: {METHODS[0]}"
    )
    group.add_argument(
        "--params",
        type=Path,
        metavar="FILE",
        help="default: params.yaml here, else the one that came with the code",
    )
    group.add_argument(
        "--set",
        dest="overrides",
        action="extend",
        nargs="+",
        default=[],
        metavar="KEY=VALUE",
        help="such as method.industnerf.grid_res=48 or seed=1; VALUE is JSON or a word",
    )
    group.add_argument("--print-config", action="store_true", help="print the settings used")


def _color(text: str) -> FloatTriple:
    if text.lower() in COLORS:
        return COLORS[text.lower()]
    if not re.fullmatch(r"#[0-9a-fA-F]{6}", text):
        raise argparse.ArgumentTypeError(f"{text!r} is not {', '.join(COLORS)} or #rrggbb")
    red, green, blue = bytes.fromhex(text[1:])
    return red / 255, green / 255, blue / 255


def _finite_float(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is no number")
    return value


def _positive_float(text: str) -> float:
    if (value := _finite_float(text)) <= 0:
        raise argparse.ArgumentTypeError(f"{text} is not above 0")
    return value


def _non_negative_float(text: str) -> float:
    if (value := _finite_float(text)) < 0:
        raise argparse.ArgumentTypeError(f"{text} is below 0")
    return value


def _int_at_least(minimum: int) -> Callable[[str], int]:
    def parse_int(text: str) -> int:
        if not re.fullmatch(r"\d+", text) or int(text) < minimum:
            raise argparse.ArgumentTypeError(f"{text} is no whole number of at least {minimum}")
        return int(text)

    return parse_int
