"""Mitsuba 3 on our views: a mesh from the visual hull, optimized by differentiable rendering.

python -m zipfile -e data/views/enclosure-120x80x40/photographs.zip enclosure
python benchmarks/peers/mitsuba/reconstruct.py enclosure out.ply

Needs `pip install mitsuba cholespy` and LLVM 19, whose libLLVM-19.so DRJIT_LIBLLVM_PATH names
(Debian: libllvm19; LLVM 15 fails on its code).  It is given the training photographs and the
background, from which it takes the silhouettes.  A pixel is diffuse reflectance under an
environment map; vertices, reflectance and environment are optimized together, vertices by large
steps (Nicolet et al., 2021: Large steps in inverse rendering of geometry).  Discontinuities of
outlines are by projective sampling (Zhang et al., 2023: Projective sampling for differentiable
rendering); those of shadows are left out, with which a step takes 20 times as long.
"""

import argparse
import json
import time
from dataclasses import dataclass
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np
from PIL import Image
from scipy.ndimage import distance_transform_edt, gaussian_filter, map_coordinates
from skimage.measure import marching_cubes

mi.set_variant("llvm_ad_rgb")  # before any of its types is named

FOREGROUND = 0.04  # difference from the background that is the part
MARGIN = 1.02  # of the hull's box over the part
FLIP = np.diag([-1.0, 1.0, -1.0, 1.0])  # from OpenGL's camera axes to Mitsuba's
SMOOTHNESS = 12.0  # lambda of the large steps
RATES = {"vertices": 4e-3, "reflectance": 2e-2, "environment": 2e-2}


@dataclass(frozen=True)
class Views:
    """The training photographs, of `size` pixels, in a world where the part is about 1 large."""

    images: np.ndarray  # (n, size, size, 3), linear
    masks: np.ndarray  # (n, size, size), in [0, 1]
    poses: np.ndarray  # (n, 4, 4), camera to world, OpenGL
    opening: float  # degrees across
    focal: float  # px
    size: int
    center: np.ndarray  # mm
    scale: float  # mm


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("views", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--steps", type=int, default=250)
    parser.add_argument("--minutes", type=float, default=3, help="of the processor, and no more")
    parser.add_argument("--batch", type=int, default=2, help="views a step")
    parser.add_argument("--size", type=int, default=128, help="px")
    parser.add_argument("--spp", type=int, default=8, help="samples a pixel")
    parser.add_argument("--grid", type=int, default=80, help="cells of the hull along each axis")
    arguments = parser.parse_args()
    start, start_wall = time.process_time(), time.perf_counter()
    views = load_views(arguments.views, arguments.size)
    vertices, faces = visual_hull(views, arguments.grid)
    print(f"hull: {len(vertices)} vertices, {len(faces)} faces", flush=True)
    optimized = optimize(views, vertices, faces, arguments)
    write_mesh(arguments.out, views.center + views.scale * optimized, faces)
    seconds, wall = time.process_time() - start, time.perf_counter() - start_wall
    print(f"{arguments.out}: {seconds:.0f} processor seconds, {wall:.0f} by the clock")


def load_views(folder: Path, size: int) -> Views:
    tree = json.loads((folder / "transforms.json").read_text())
    train = set(tree["train_filenames"])
    frames = [frame for frame in tree["frames"] if frame["file_path"] in train]
    poses = np.array([frame["transform_matrix"] for frame in frames])
    background = np.array(tree["background"])
    files = [folder / frame["file_path"] for frame in frames]
    full = np.stack([np.asarray(Image.open(file).convert("RGB")) for file in files]) / 255
    foreground = (np.abs(full - background) > FOREGROUND).any(axis=-1).astype(np.float64)
    images, masks = reduce(full, size), reduce(foreground[..., None], size)[..., 0]
    # the point that all cameras look at, and a length of about the part
    origins, forward = poses[:, :3, 3], -poses[:, :3, 2]
    across = np.eye(3) - forward[:, :, None] * forward[:, None, :]
    center = np.linalg.solve(across.sum(axis=0), (across @ origins[..., None]).sum(axis=0))[:, 0]
    distance = np.linalg.norm(origins - center, axis=1).mean()
    width = np.sqrt(foreground.mean(axis=(1, 2)).max()) * tree["w"] / tree["fl_x"]
    scale = float(distance * width)
    poses[:, :3, 3] = (origins - center) / scale
    opening = 2 * np.degrees(np.arctan(tree["w"] / 2 / tree["fl_x"]))
    focal = tree["fl_x"] * size / tree["w"]
    return Views(images, masks, poses, float(opening), focal, size, center, scale)


def reduce(images: np.ndarray, size: int) -> np.ndarray:
    """The mean over areas, by way of PIL's box filter."""
    channels = images.shape[-1]
    planes = [
        np.stack(
            [
                np.asarray(
                    Image.fromarray(image[..., c].astype(np.float32)).resize(
                        (size, size), Image.Resampling.BOX
                    )
                )
                for c in range(channels)
            ],
            axis=-1,
        )
        for image in images
    ]
    return np.stack(planes)


def visual_hull(views: Views, cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Marching cubes on the least signed distance to any silhouette, in a box that fits."""
    half = np.full(3, 1.2)
    for fit in (40, cells):  # a coarse hull first, whose box the fine one takes
        axes = [np.linspace(-side, side, fit) for side in half]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
        depth = np.full(len(points), np.inf)
        for mask, pose in zip(views.masks, views.poses, strict=True):
            inside = mask > 0.5
            signed = distance_transform_edt(inside) - distance_transform_edt(~inside)
            camera = (points - pose[:3, 3]) @ pose[:3, :3]
            uv = views.focal * camera[:, :2] / -camera[:, 2:] * (1, -1) + views.size / 2 - 0.5
            depth = np.minimum(depth, map_coordinates(signed, uv.T[::-1], order=1, mode="nearest"))
        # smoothed by a cell: silhouettes of whole pixels leave crumbs
        field = gaussian_filter(np.clip(depth, -4, 4).reshape(fit, fit, fit), 1.0)
        half = MARGIN * np.abs(points[depth > 0]).max(axis=0) + 2.4 / 40
    spacing = [axis[1] - axis[0] for axis in axes]
    vertices, faces, _, _ = marching_cubes(field, 0.0, spacing=spacing)
    return vertices + [axis[0] for axis in axes], faces[:, ::-1]


def optimize(
    views: Views, vertices: np.ndarray, faces: np.ndarray, arguments: argparse.Namespace
) -> np.ndarray:
    """The vertices after all steps."""
    scene = mi.load_dict(scene_of(vertices, faces))
    parameters = mi.traverse(scene)
    position, color, light = (
        "part.vertex_positions",
        "part.vertex_color",
        "light.data",
    )
    parameters.keep([position, color, light])
    steps = mi.ad.LargeSteps(parameters[position], mi.UInt(faces.ravel()), SMOOTHNESS)
    optimizer = mi.ad.Adam(lr=RATES["reflectance"], uniform=False)
    optimizer["latent"] = steps.to_differential(parameters[position])
    optimizer[color], optimizer[light] = parameters[color], parameters[light]
    optimizer.set_learning_rate({"latent": RATES["vertices"], light: RATES["environment"]})
    integrator = mi.load_dict({"type": "direct_projective", "hide_emitters": True, "sppi": 0})
    # one sensor that moves: a pose that is part of the code would be compiled, view by view
    sensor = sensor_of(views, views.poses[0])
    sensor_parameters = mi.traverse(sensor)
    order, end = np.random.default_rng(0), time.process_time() + 60 * arguments.minutes
    for step in range(arguments.steps):
        parameters[position] = steps.from_differential(optimizer["latent"])
        parameters[color] = dr.clip(optimizer[color], 0, 1)
        parameters[light] = dr.maximum(optimizer[light], 0)
        parameters.update()
        loss = 0.0
        for view in order.choice(len(views.poses), arguments.batch, replace=False):
            pose = mi.Transform4f(views.poses[view] @ FLIP)
            dr.make_opaque(pose)
            sensor_parameters["to_world"] = pose
            sensor_parameters.update()
            image = mi.render(
                scene,
                parameters,
                sensor=sensor,
                integrator=integrator,
                spp=arguments.spp,
                seed=step * len(views.poses) + int(view),
            )
            # on black, which the hidden environment leaves; the integrator's alpha is 1 everywhere
            target = mi.TensorXf(views.images[view] * views.masks[view][..., None])
            loss += dr.mean(dr.square(image - target), axis=None)
        dr.backward(loss)
        optimizer.step()
        if step % 5 == 0:
            print(f"step {step}: loss {np.array(loss).item():.5f}", flush=True)
        if time.process_time() > end:
            print(f"ends after {step + 1} steps: the time is used up")
            break
    return np.array(steps.from_differential(optimizer["latent"])).reshape(-1, 3)


def scene_of(vertices: np.ndarray, faces: np.ndarray) -> dict:
    gray = mi.load_dict(
        {
            "type": "diffuse",
            "reflectance": {"type": "mesh_attribute", "name": "vertex_color"},
        }
    )
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict({"type": "twosided", "bsdf": gray})
    mesh = mi.Mesh("part", len(vertices), len(faces), properties)
    mesh.add_attribute("vertex_color", 3, np.full(3 * len(vertices), 0.5))
    values = mi.traverse(mesh)
    values["vertex_positions"] = mi.Float(vertices.ravel())
    values["faces"] = mi.UInt(faces.ravel().astype(np.uint32))
    values.update()
    sky = mi.Bitmap(np.full((8, 16, 3), 0.8, np.float32))
    return {"type": "scene", "part": mesh, "light": {"type": "envmap", "bitmap": sky}}


def sensor_of(views: Views, pose: np.ndarray) -> mi.Sensor:
    return mi.load_dict(
        {
            "type": "perspective",
            "fov": views.opening,
            "to_world": mi.ScalarTransform4f(pose @ FLIP),
            "film": {
                "type": "hdrfilm",
                "width": views.size,
                "height": views.size,
                "pixel_format": "rgb",
                "rfilter": {"type": "box"},
            },
        }
    )


def write_mesh(path: Path, vertices: np.ndarray, faces: np.ndarray) -> None:
    """As PLY, in mm."""
    import trimesh

    trimesh.Trimesh(vertices, faces, process=False).export(path)


if __name__ == "__main__":
    main()
