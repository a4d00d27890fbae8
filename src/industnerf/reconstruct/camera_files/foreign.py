"""Camera files of other programs: told by content, and named with the way to convert them."""

import json
import shlex
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from industnerf.errors import BadArtifact

KNOWN = (
    "transforms.json of nerfstudio, instant-ngp or Blender, a COLMAP model and sdfstudio's "
    "meta_data.json are read"
)
PHOTOGRAPHS_ALONE = "--sfm finds the cameras anew from the photographs alone"


@dataclass(frozen=True)
class Foreign:
    """A format: its name, how it is told, and what to do; {path} and {out} stand for paths."""

    name: str
    is_it: Callable[[Any], bool]  # of the first bytes, or of the JSON
    remedy: str


BYTES = (
    Foreign(
        "cameras of Agisoft Metashape (XML)",
        lambda head: b"<document" in head and b"<chunk" in head,
        "convert it by nerfstudio: ns-process-data metashape --data images --xml {path} "
        "--output-dir {out}; or export COLMAP from Metashape (File > Export > Export Cameras)",
    ),
    Foreign(
        "a block of Bentley's BlocksExchange (XML)",
        lambda head: b"<BlocksExchange" in head,
        "export COLMAP from the program that wrote it",
    ),
    Foreign(
        "cameras of RealityCapture (CSV)",
        lambda head: head.lstrip(b"\xef\xbb\xbf").lower().startswith(b"#name,"),
        "convert it by nerfstudio: ns-process-data realitycapture --data images --csv {path} "
        "--output-dir {out}; or export COLMAP from RealityCapture (Export > Registration)",
    ),
    Foreign(
        "a database of COLMAP",
        lambda head: head.startswith(b"SQLite format 3\0"),
        "it holds no poses yet: colmap mapper --database_path {path} --image_path images "
        "--output_path {out}, then give --cameras {out}/0",
    ),
    Foreign(
        "a bundle of Bundler",
        lambda head: head.startswith(b"# Bundle file"),
        "export COLMAP from the program that wrote it",
    ),
    Foreign(
        "a model of VisualSFM (NVM)",
        lambda head: head.startswith(b"NVM_V3"),
        "export COLMAP from the program that wrote it",
    ),
    Foreign(
        "a scene of AliceVision (Alembic)",
        lambda head: head.startswith(b"Ogawa"),
        "convert it: aliceVision_exportColmap -i {path} -o {out}, then give --cameras {out}",
    ),
    Foreign(
        "cameras of Pix4D",
        lambda head: head.startswith(b"fileName imageWidth imageHeight"),
        "export COLMAP from the program that wrote it",
    ),
    Foreign(
        "an array of numpy, as LLFF's poses_bounds.npy",
        lambda head: head.startswith(b"\x93NUMPY"),
        "LLFF made it from a COLMAP model: give that, its sparse/0",
    ),
    Foreign(
        "an archive of numpy, as the cameras.npz of NeuS and IDR",
        lambda head: head.startswith(b"PK") and b".npy" in head,
        "write transforms.json from its world_mat, or give the model that it was made from",
    ),
)
JSONS = (
    Foreign(
        "sfm_data.json of OpenMVG",
        lambda content: isinstance(content, dict) and "sfm_data_version" in content,
        "convert it: openMVG_main_openMVG2Colmap -i {path} -o {out}, then give --cameras {out}",
    ),
    Foreign(
        "a scene of Meshroom (AliceVision)",
        lambda content: (
            isinstance(content, dict)
            and isinstance(content.get("views"), list)
            and not {"poses", "intrinsics"}.isdisjoint(content)
        ),
        "convert it: aliceVision_exportColmap -i {path} -o {out}, then give --cameras {out}",
    ),
    Foreign(
        "a reconstruction of OpenSfM or OpenDroneMap",
        lambda content: (
            isinstance(content, list)
            and bool(content)
            and isinstance(content[0], dict)
            and "shots" in content[0]
        ),
        "convert it: opensfm export_colmap on the folder of {path}",
    ),
    Foreign(
        "a trajectory of Open3D",
        lambda content: (
            isinstance(content, dict) and content.get("class_name") == "PinholeCameraTrajectory"
        ),
        "it names no photographs: write transforms.json, inverting each extrinsic",
    ),
    Foreign(
        "metadata of Record3D",
        lambda content: isinstance(content, dict) and {"poses", "K"} <= content.keys(),
        "convert it by nerfstudio: ns-process-data record3d --data {folder} --output-dir {out}",
    ),
)


def refuse_foreign_bytes(path: Path, head: bytes) -> None:
    """Raise BadArtifact: a file that begins with `head` and is no JSON is none of ours."""
    _refuse(path, BYTES, head)
    if not head.strip():
        raise BadArtifact(f"{path} is not readable JSON: it is empty")
    try:
        json.loads(head.decode("utf-8-sig"))
    except ValueError as error:
        raise BadArtifact(
            f"{path} is not readable JSON: {error}, and of no other kind that is told here: {KNOWN}"
        ) from None


def refuse_foreign_json(path: Path, content: Any) -> None:
    """Raise BadArtifact that names the format if `content` is of another program's."""
    _refuse(path, JSONS, content)


def _refuse(path: Path, formats: tuple[Foreign, ...], evidence: Any) -> None:
    for foreign in formats:
        if foreign.is_it(evidence):
            words = {"path": path, "out": path.parent / "converted", "folder": path.parent}
            remedy = foreign.remedy.format(
                **{key: shlex.quote(str(value)) for key, value in words.items()}
            )
            raise BadArtifact(
                f"{path}: is {foreign.name}, which is not read here; {remedy}. {KNOWN}; "
                f"{PHOTOGRAPHS_ALONE}"
            )
