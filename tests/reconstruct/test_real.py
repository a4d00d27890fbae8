"""The command over the method itself: photographs of a ball to a cloud on the ball."""

import json
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image

from industnerf.reconstruct import __main__ as command
from industnerf.torch_kernels import use_reproducible_kernels
from tests.methods.industnerf.synthetic_scenes import CENTER, ball, orbit_cameras, render_images
from tests.reconstruct import sample_images

RADIUS = 18.0
SETTINGS = {
    "industnerf_plus": (
        "grid_res=20",
        'levels=[{"steps": 100, "image_px": 48, "points": 2000}]',
        "rays_per_step=512",
        "surface_spacing=0.05",
        "polish.steps=10",
    ),
    "industnerf": (
        "grid_res=12",
        'levels=[{"steps": 20, "image_px": 32, "points": 2000}]',
        "rays_per_step=256",
        "readings.extraction=confident_points",
        "min_confidence=0.01",
    ),
}


@pytest.fixture
def ball_images(tmp_path) -> Path:
    """transforms.json beside 16 photographs of 48 px."""
    use_reproducible_kernels()
    cameras = orbit_cameras(16, 48)
    (tmp_path / "rgb").mkdir()
    for i, pixels in enumerate(render_images(ball(RADIUS), cameras)):
        Image.fromarray(pixels).save(tmp_path / f"rgb/{i:03d}.png")
    return sample_images.write_json_file(
        tmp_path / "transforms.json", sample_images.transforms_content(cameras)
    )


def reconstruct(
    transforms: Path, out: Path, method: str, monkeypatch: pytest.MonkeyPatch, *more: str
) -> int:
    values = [f"method.{method}.{setting}" for setting in SETTINGS[method]]
    command_line = [
        "--cameras",
        transforms,
        "--out",
        out,
        "--method",
        method,
        "--preview-every",
        "0",
    ]
    monkeypatch.setattr(
        sys, "argv", ["reconstruct", *map(str, command_line), *more, "--set", *values]
    )
    return command.main()


def test_cloud_and_mesh_lie_near_the_ball(ball_images, tmp_path, monkeypatch, capsys):
    out, mesh = tmp_path / "cloud.ply", tmp_path / "mesh.stl"
    more = ("--mesh", str(mesh))
    assert reconstruct(ball_images, out, "industnerf_plus", monkeypatch, *more) == 0
    cloud, surface = trimesh.load(out), trimesh.load(mesh)
    surface.merge_vertices()
    error = np.linalg.norm(cloud.vertices - CENTER, axis=1) - RADIUS
    # cells of 3 mm and pixels of 2.7 mm; points all over the ball that is in frame are 8 mm off
    assert np.abs(error).mean() < 2
    assert surface.is_watertight
    assert surface.volume > 0
    error = np.linalg.norm(surface.vertices - CENTER, axis=1) - RADIUS
    assert np.abs(error).mean() < 2
    assert b"comment lengths in the cameras' unit\n" in out.read_bytes()
    assert "110 steps" in capsys.readouterr().out


@pytest.mark.parametrize("method", SETTINGS)
def test_an_interrupted_run_goes_on(ball_images, tmp_path, monkeypatch, capsys, method):
    """To the same bytes, from where it stopped: at once, or where all views are told by E anew."""
    whole, out = tmp_path / "whole.ply", tmp_path / "cloud.ply"
    assert reconstruct(ball_images, whole, method, monkeypatch) == 0
    with monkeypatch.context() as patch:
        # looked up here, for tests with a stand-in for the method load this module anew
        callback_class = import_module("industnerf.reconstruct.run").CliCallback
        original_step, losses = callback_class.on_step_end, []

        def stop_after_seven(self: Any, loss: float) -> None:
            original_step(self, loss)
            losses.append(loss)
            self._interrupt.requested = len(losses) >= 7

        patch.setattr(callback_class, "on_step_end", stop_after_seven)
        assert reconstruct(ball_images, out, method, monkeypatch) == 130
    assert not out.exists()
    assert reconstruct(ball_images, out, method, monkeypatch) == 0
    assert "going on from" in capsys.readouterr().out
    assert out.read_bytes() == whole.read_bytes()


def test_the_state_of_a_run_is_what_the_file_takes(ball_images, tmp_path, monkeypatch, capsys):
    """Checkpoints after every step, without a complaint."""
    out = tmp_path / "cloud.ply"
    code = reconstruct(ball_images, out, "industnerf", monkeypatch, "--checkpoint-every", "1e-9")
    assert code == 0
    assert "going on without" not in capsys.readouterr().out
    assert json.loads(ball_images.read_text())["w"] == 48
