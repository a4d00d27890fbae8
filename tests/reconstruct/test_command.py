"""The command as a user gives it, over a stand-in for the method."""

import json
import os
import shutil
import signal
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
import trimesh
from PIL import Image

from industnerf.artifacts import files
from industnerf.geometry.cameras import common_view_ball
from industnerf.seeds import seed_for
from tests.reconstruct import fake_pipeline, sample_images

ALMOST_ZERO = 1e-9  # seconds: due whenever asked


def ctrl_c():
    os.kill(os.getpid(), signal.SIGINT)


def test_the_cloud_is_in_the_cameras_frame_and_unit(workspace, fake):
    code, text, errors = workspace.run("--npz")
    assert (code, errors) == (0, "")
    assert f"{workspace.out}: 6 points, 6 steps, 4 parameters; " in text
    assert "MB" in text
    cloud = np.load(workspace.folder / "cloud.npz")
    read = trimesh.load(workspace.out)
    np.testing.assert_array_equal(read.vertices, cloud["points"])
    np.testing.assert_array_equal(read.colors[:, :3], cloud["colors"])
    center, radius = common_view_ball(sample_images.cameras())
    assert (np.abs(cloud["points"] - center) <= radius * (1 + 1e-6)).all()  # float32
    assert [path.split("/")[-1] for path in cloud["image_paths"]] == [
        f"{i:03d}.png" for i in range(5)
    ]
    names = {"cloud.ply", "cloud.ply.png", "cloud.npz"}  # the picture is from four sides
    assert workspace.files() == {"set", "params.yaml"} | names


def test_the_ply_says_what_it_holds(workspace):
    workspace.run()
    header, _, body = workspace.out.read_bytes().partition(b"end_header\n")
    properties = [line[9:] for line in header.decode().splitlines() if line.startswith("property")]
    assert properties == [
        *("float x", "float y", "float z", "uchar red", "uchar green", "uchar blue"),
        *("float confidence", "float quality", "short view"),
    ]
    assert len(body) == 6 * (3 * 4 + 3 + 2 * 4 + 2)


@pytest.mark.parametrize("word", ["white", "White", "WHITE", "#FFFFFF"])
def test_a_color_is_one_however_it_is_written(workspace, fake, word):
    workspace.run("--background", word)
    np.testing.assert_array_equal(fake.LAST_CALL["posed_images"].background, np.ones((5, 3)))


def test_the_method_gets_what_the_user_gave(workspace, fake):
    workspace.run("--set", "method.industnerf.rate=2e-3", "seed=9", "--background", "#0000ff")
    posed_images = fake.LAST_CALL["posed_images"]
    np.testing.assert_array_equal(posed_images.rgb, sample_images.images())
    np.testing.assert_array_equal(posed_images.background, [[0, 0, 1]] * 5)
    assert (fake.LAST_CALL["settings"].rate, fake.LAST_CALL["settings"].steps) == (2e-3, 6)
    assert fake.LAST_CALL["seed"] == seed_for(9, "reconstruct", "industnerf")
    workspace.run("--force", "--method", "industnerf_plus", "--center", 9, -4, 3, "--radius", 0.5)
    assert fake.LAST_CALL["settings"].steps == 2
    assert fake.LAST_CALL["posed_images"].background is None
    assert (
        fake.LAST_CALL["posed_images"].center.tolist(),
        fake.LAST_CALL["posed_images"].radius,
    ) == ([9, -4, 3], 0.5)


@pytest.mark.parametrize("y", ["-4", "-4.", "-4e0", "-.4E+1"])
def test_a_center_may_be_negative_however_it_is_written(workspace, fake, y):
    """The command itself says -2.3e-05."""
    code, *_ = workspace.run("--center", 9, y, 3, "--radius", 0.5)
    assert code == 0
    assert fake.LAST_CALL["posed_images"].center.tolist() == [9, -4, 3]


def test_images_may_lie_elsewhere(workspace, fake):
    (workspace.folder / "set/rgb").rename(workspace.folder / "photos")
    code, *_ = workspace.run("--images", workspace.folder / "photos")
    assert code == 0
    np.testing.assert_array_equal(fake.LAST_CALL["posed_images"].rgb, sample_images.images())


@pytest.mark.parametrize(
    ("name", "complaint"),
    [
        ("none", "does not exist"),
        ("params.yaml", "is no folder"),
        ("empty", "none of the 5 photographs is found there, the first is "),
        ("others", "none of the 5 photographs is found there"),
    ],
)
def test_a_folder_that_was_named_is_not_passed_over(workspace, fake, name, complaint):
    """Though all photographs are beside the cameras."""
    (workspace.folder / "empty").mkdir()
    (workspace.folder / "others").mkdir()
    (workspace.folder / "others/7.png").touch()
    code, _, errors = workspace.run("--images", workspace.folder / name)
    assert (code, f"--images {workspace.folder / name}: {complaint}" in errors) == (2, True)
    assert fake.LAST_CALL == {}


def test_photographs_from_beside_the_cameras_are_counted(workspace, fake):
    """The folder has three; what it goes before is no stranger."""
    (workspace.folder / "photos").mkdir()
    for i in range(3):
        flat = np.full((sample_images.HEIGHT, sample_images.WIDTH, 3), i, np.uint8)
        Image.fromarray(flat).save(workspace.folder / f"photos/{i:03d}.png")
    code, text, _ = workspace.run("--images", workspace.folder / "photos")
    assert code == 0
    output = " ".join(text.split())
    assert (
        f"2 of 5 photographs are not in --images {workspace.folder / 'photos'}: taken from"
        in output
    )
    assert f"the first as {workspace.folder / 'set/rgb/003.png'}" in output
    assert "no frame names" not in output
    assert fake.LAST_CALL["posed_images"].rgb[:, 0, 0, 0].tolist()[:3] == [0, 1, 2]


def test_settings_are_shown_on_request(workspace):
    _, text, _ = workspace.run("--print-config", "--set", "method.industnerf.reading=printed")
    for line in (
        'method.industnerf.reading = "printed"',
        "method.industnerf.steps = 6",
        "seed = 3",
    ):
        assert line in text


def test_an_interrupted_run_goes_on_to_the_same_bytes(workspace, fake):
    workspace.run("--out", workspace.folder / "whole.ply")
    fake.HOOKS[3] = ctrl_c
    code, text, errors = workspace.run()
    assert code == 130
    assert f"the same command goes on from {workspace.checkpoint}" in errors
    assert not workspace.out.exists()
    fake.HOOKS.clear()
    code, text, _ = workspace.run()
    assert code == 0
    assert f"going on from {workspace.checkpoint}" in text
    assert len(fake.LAST_CALL["resume"]["points"]) == 4  # the step that was under way was finished
    assert workspace.out.read_bytes() == (workspace.folder / "whole.ply").read_bytes()
    assert not workspace.checkpoint.exists()


def test_a_second_ctrl_c_ends_at_once_and_keeps_the_last_checkpoint(workspace, fake):
    fake.HOOKS[3] = lambda: (ctrl_c(), ctrl_c())
    code, *_ = workspace.run("--checkpoint-every", ALMOST_ZERO)
    assert (code, workspace.checkpoint.exists()) == (130, True)
    fake.HOOKS.clear()
    workspace.run()
    assert len(fake.LAST_CALL["resume"]["points"]) == 3


def test_an_interrupted_fresh_start_goes_on_without_fresh(workspace, fake):
    """With it, the same command would drop what was just kept."""
    fake.HOOKS[3] = ctrl_c
    code, _, errors = workspace.run("--no-resume")
    assert code == 130
    assert f"the same command without --no-resume goes on from {workspace.checkpoint}" in errors
    fake.HOOKS.clear()
    workspace.run()
    assert len(fake.LAST_CALL["resume"]["points"]) == 4


def test_an_early_ctrl_c_keeps_nothing_and_says_so(workspace, fake):
    fake.HOOKS[0] = lambda: (ctrl_c(), ctrl_c())
    code, _, errors = workspace.run()
    assert (code, errors) == (130, "interrupted; nothing of this run is kept\n")
    assert workspace.files() == {"set", "params.yaml"}


def test_what_an_earlier_run_kept_is_not_taken_for_this_ones(workspace, fake):
    """With --no-resume it is dropped, and belongs to another run."""
    fake.HOOKS[3] = ctrl_c
    assert workspace.run()[0] == 130
    os.utime(workspace.checkpoint, (0, 0))
    fake.HOOKS.clear()
    fake.HOOKS[0] = lambda: (ctrl_c(), ctrl_c())
    code, _, errors = workspace.run("--no-resume")
    assert (code, errors) == (130, "interrupted; nothing of this run is kept\n")


def crash():
    raise RuntimeError("as if the power went")


def leave_checkpoint(workspace, fake, *arguments):
    """Leaves a checkpoint behind."""
    fake.HOOKS[3] = crash
    with pytest.raises(RuntimeError, match="power"):
        workspace.run("--checkpoint-every", ALMOST_ZERO, *arguments)
    fake.HOOKS.clear()
    assert workspace.checkpoint.exists()


def test_checkpoints_outlive_a_crash(workspace, fake):
    leave_checkpoint(workspace, fake)
    assert workspace.run()[0] == 0
    assert len(fake.LAST_CALL["resume"]["points"]) == 3


def test_nought_seconds_mean_never(workspace, fake):
    fake.HOOKS[3] = crash
    with pytest.raises(RuntimeError, match="power"):
        workspace.run("--checkpoint-every", 0, "--preview-every", 0)
    assert workspace.files() == {"set", "params.yaml"}


def test_a_fresh_start_forgets_at_once(workspace, fake):
    """Else a crash before its first checkpoint would let the dropped run go on."""
    leave_checkpoint(workspace, fake)
    fake.HOOKS[0] = crash
    with pytest.raises(RuntimeError, match="power"):
        workspace.run("--no-resume")
    assert not workspace.checkpoint.exists()


def change_photo(workspace):
    Image.fromarray(sample_images.images()[0]).save(workspace.folder / "set/rgb/004.png")


def change_camera(workspace):
    transforms = json.loads(workspace.transforms.read_text())
    sample_images.write_json_file(workspace.transforms, transforms | {"fl_x": 61.0})


@pytest.mark.parametrize(
    ("change", "arguments", "differs"),
    [
        (change_photo, (), "images differ"),
        (change_camera, (), "cameras differ"),
        (None, ("--set", "method.industnerf.rate=1"), "settings differ"),
        (None, ("--set", "seed=4"), "seed differ"),
        (None, ("--method", "industnerf_plus"), "method, settings differ"),
        (None, ("--radius", "1"), "region of interest differ"),
        (None, ("--background", "white"), "background differ"),
    ],
)
def test_a_checkpoint_of_other_inputs_is_refused(workspace, fake, change, arguments, differs):
    leave_checkpoint(workspace, fake)
    if change:
        change(workspace)
    code, _, errors = workspace.run(*arguments)
    assert code == 2
    assert differs in errors
    assert "--no-resume" in errors
    assert workspace.run("--no-resume", *arguments)[0] == 0
    assert fake.LAST_CALL["resume"] is None
    assert not workspace.checkpoint.exists()


def test_a_checkpoint_of_another_kind_of_device_is_refused(workspace, fake, monkeypatch):
    """There roundings sort other points out than those whose numbers it holds."""
    leave_checkpoint(workspace, fake)
    monkeypatch.setattr("industnerf.reconstruct.checkpoint.device", lambda: torch.device("meta"))
    code, _, errors = workspace.run()
    assert (code, "another run: device differ" in errors) == (2, True)


def test_a_torn_checkpoint_is_refused(workspace, fake):
    leave_checkpoint(workspace, fake)
    workspace.checkpoint.write_bytes(workspace.checkpoint.read_bytes()[:-9])
    code, _, errors = workspace.run()
    assert (code, "is torn" in errors) == (2, True)
    assert workspace.run("--no-resume")[0] == 0


def test_a_file_that_is_no_checkpoint_is_never_replaced(workspace):
    photo = workspace.folder / "mine.png"
    Image.fromarray(sample_images.images()[0]).save(photo)
    before = photo.read_bytes()
    for extra in ((), ("--no-resume",)):
        code, _, errors = workspace.run("--checkpoint", photo, *extra)
        assert (code, "is there and is no checkpoint" in errors) == (2, True)
    assert photo.read_bytes() == before


@pytest.mark.parametrize("name", ["cloud.ply", "cloud.npz", "mine.png", "mesh.stl"])
def test_what_is_there_stays_unless_forced(workspace, fake, name):
    (workspace.folder / name).write_text("dear")
    arguments = ("--mesh", workspace.folder / "mesh.stl")
    arguments += (
        "--npz",
        "--preview",
        workspace.folder / "mine.png",
        "--preview-every",
        ALMOST_ZERO,
    )
    code, _, errors = workspace.run(*arguments)
    assert (code, f"{name} is there already; --force" in errors) == (2, True)
    assert (workspace.folder / name).read_text() == "dear"
    assert fake.LAST_CALL == {}
    assert workspace.run("--force", *arguments)[0] == 0
    assert not (workspace.folder / name).read_bytes().startswith(b"dear")


def test_a_run_that_goes_on_may_renew_its_preview(workspace, fake):
    arguments = ("--preview", workspace.folder / "mine.png", "--preview-every", ALMOST_ZERO)
    leave_checkpoint(workspace, fake, *arguments)
    assert (workspace.folder / "mine.png").exists()
    assert workspace.run(*arguments)[0] == 0


def test_a_fresh_start_has_no_preview_of_its_own(workspace, fake):
    leave_checkpoint(workspace, fake, "--preview-every", 0)
    (workspace.folder / "mine.png").write_text("dear")
    arguments = (
        "--no-resume",
        "--preview",
        workspace.folder / "mine.png",
        "--preview-every",
        ALMOST_ZERO,
    )
    code, _, errors = workspace.run(*arguments)
    assert (code, "mine.png is there already; --force" in errors) == (2, True)
    assert (workspace.folder / "mine.png").read_text() == "dear"
    assert workspace.checkpoint.exists()
    assert workspace.run("--force", *arguments)[0] == 0


@pytest.mark.parametrize("option", ["--out", "--checkpoint", "--preview", "--mesh"])
def test_a_folder_is_refused_before_any_work(workspace, fake, option):
    (workspace.folder / "mine.ply").mkdir()
    for extra in ((), ("--force",)):
        code, _, errors = workspace.run(option, workspace.folder / "mine.ply", *extra)
        assert (code, "mine.ply: is a folder" in errors) == (2, True)
    assert fake.LAST_CALL == {}


@pytest.mark.parametrize("option", ["--out", "--checkpoint", "--preview", "--mesh"])
@pytest.mark.parametrize("kind", ["shared", "held out", "cameras", "settings", "a link"])
def test_an_input_is_never_overwritten(workspace, fake, option, kind):
    """Each is given a name that the option takes, which may be a link to it."""
    sample_images.write_json_file(
        workspace.transforms,
        json.loads(workspace.transforms.read_text())
        | {"train_filenames": [f"rgb/{i:03d}.png" for i in range(4)]},
    )
    targets = {
        "shared": workspace.folder / "set/rgb/000.png",
        "held out": workspace.folder / "set/rgb/004.png",
        "cameras": workspace.transforms,
        "settings": workspace.folder / "params.yaml",
        "a link": workspace.folder / "set/rgb/000.png",
    }
    name = workspace.folder / "mine.ply"
    (name.hardlink_to if kind == "a link" else name.symlink_to)(targets[kind])
    before = targets[kind].read_bytes()
    code, _, errors = workspace.run(option, name, "--force")
    assert (code, f"{option} {name}: is an input of this run" in errors) == (2, True)
    assert targets[kind].read_bytes() == before
    assert fake.LAST_CALL == {}


def test_one_file_cannot_be_two(workspace):
    code, _, errors = workspace.run("--checkpoint", workspace.out)
    assert (code, "must be different files" in errors) == (2, True)


def test_a_preview_shows_photograph_and_rendering(workspace):
    workspace.run("--preview-every", ALMOST_ZERO)
    with Image.open(f"{workspace.out}.preview.png") as image:
        preview = np.asarray(image)
    source = sample_images.images()[0]
    np.testing.assert_array_equal(preview[:, : sample_images.WIDTH], source)
    np.testing.assert_array_equal(preview[:, -sample_images.WIDTH :], 255 - source)


def test_a_run_goes_on_without_what_cannot_be_written(workspace, fake, monkeypatch):
    """A disk that is full while the run lasts, and has room again at its end."""

    def raise_disk_full(descriptor):
        raise OSError(28, "No space left on device")

    def fill_disk():
        monkeypatch.setattr(files.os, "fsync", raise_disk_full)

    fake.HOOKS.update({2: fill_disk, 5: monkeypatch.undo})
    arguments = ("--checkpoint-every", ALMOST_ZERO, "--preview-every", ALMOST_ZERO)
    code, text, _ = workspace.run(*arguments)
    assert code == 0
    assert text.count("going on without: ") == 2 * 3
    assert "No space left on device" in text


def test_no_surface_is_a_failure_and_no_users_error(workspace):
    code, _, errors = workspace.run("--set", "method.industnerf.steps=0")
    assert code == 1
    assert errors.startswith("error: the method found no surface")
    assert not workspace.out.exists()


def test_points_that_are_not_finite_are_a_failure(workspace, fake, monkeypatch):
    original_run = fake.run

    def run_with_nan(*args):
        result = original_run(*args)
        result.points[2:4, 1] = np.nan
        return result

    monkeypatch.setattr(fake, "run", run_with_nan)
    code, _, errors = workspace.run()
    assert (code, errors) == (1, "error: not finite: 2 of 6 points\n")


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("--out", "cloud.obj"), "must end in .ply"),
        (("--mesh", "part.step"), "must end in .stl, .ply or .obj"),
        (("--center", "1", "2", "3"), "--center needs --radius"),
        (("--radius", "-1"), "-1 is not above 0"),
        (("--radius", "nan"), "'nan' is no number"),
        (("--max-size", "8"), "8 is no whole number of at least 16"),
        (("--background", "pink"), "'pink' is not white, gray, black or #rrggbb"),
        (("--checkpoint-every", "-1"), "-1 is below 0"),
        (("--method", "hull"), "invalid choice"),
        (("--set", "method.industnerf.step_size=1"), "method.industnerf.step_size is unknown"),
        (("--cameras", "none.json"), "none.json: cannot be read: No such file"),
        (("--images", "none", "--cameras", "none.json"), "none.json: cannot be read"),
    ],
)
def test_users_errors_are_one_sentence_and_code_2(workspace, arguments, complaint):
    code, _, errors = workspace.run(*arguments)
    assert code == 2
    assert complaint in errors
    assert "Traceback" not in errors
    assert "error: " in errors.splitlines()[-1]


def test_a_bad_photograph_is_named_with_its_frame(workspace):
    photo = workspace.folder / "set/rgb/002.png"
    photo.write_bytes(photo.read_bytes()[:300])
    code, _, errors = workspace.run()
    assert code == 2
    assert errors.startswith(f"error: frame 2 (rgb/002.png): {photo} cannot be read as an image")


@pytest.mark.parametrize(
    "change", [{"fl_x": 10**400}, {"k4": [1, [2]]}, {"w": 48.9}, {"k1": 10**400}]
)
def test_a_camera_that_is_none_is_named(workspace, change):
    transforms = json.loads(workspace.transforms.read_text())
    transforms["frames"][2] |= change
    sample_images.write_json_file(workspace.transforms, transforms)
    code, _, errors = workspace.run()
    assert (code, errors.startswith("error: frame 2 (rgb/002.png): ")) == (2, True)
    assert f"{next(iter(change))} " in errors


def test_a_photograph_without_a_camera_is_said_to_be_left_out(workspace, fake):
    (workspace.folder / "set/rgb/005.jpg").write_text("not even an image: nobody opens it")
    code, text, errors = workspace.run()
    assert (code, errors) == (0, "")
    assert "images that no frame names, left out: 1 (005.jpg)\n" in text
    np.testing.assert_array_equal(fake.LAST_CALL["posed_images"].rgb, sample_images.images())


def test_cameras_without_a_photograph_are_left_out_unless_strict(workspace, fake):
    for name in ("001", "003"):
        (workspace.folder / f"set/rgb/{name}.png").unlink()
    code, text, errors = workspace.run()
    assert (code, errors) == (0, "")
    assert "2 of 5 frames (rgb/001.png, rgb/003.png) have no photograph: left out" in text
    np.testing.assert_array_equal(
        fake.LAST_CALL["posed_images"].rgb, sample_images.images()[[0, 2, 4]]
    )
    code, _, errors = workspace.run("--strict", "--force")
    assert code == 2
    assert errors.startswith("error: frame 1 (rgb/001.png): no such photograph in ")
    assert "2 of 5 frames (rgb/001.png, rgb/003.png) have none" in errors


def test_help_needs_nothing_heavy(root):
    """In a process of its own, as the modules of this one are all there."""
    script = (
        "import runpy, sys\n"
        "sys.argv = ['x', '--help']\n"
        "try: runpy.run_module('industnerf.reconstruct', run_name='__main__')\n"
        "except SystemExit as end: assert not end.code\n"
        "print(sorted({'torch', 'numpy', 'PIL', 'scipy', 'omegaconf', 'rich'} & set(sys.modules)))"
    )
    completed = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, cwd=root
    )
    assert completed.returncode == 0, completed.stderr
    assert completed.stdout.splitlines()[-1] == "[]"
    assert "--cameras" in completed.stdout


def test_the_local_file_says_where_to_compute_and_a_device_that_is_none_is_refused(
    workspace, monkeypatch
):
    monkeypatch.setenv("INDUSTNERF_DEVICE", "")  # so that it is as before when the test is over
    monkeypatch.delenv("INDUSTNERF_DEVICE")
    monkeypatch.chdir(workspace.folder)
    (workspace.folder / ".industnerf.env").write_text("INDUSTNERF_DEVICE=gpu\n")
    code, _, errors = workspace.run()
    assert code == 2
    assert "INDUSTNERF_DEVICE is 'gpu', must be cpu, cuda or cuda:N" in errors


def test_the_ball_of_the_region_is_no_result(workspace, fake, monkeypatch):
    """It is written all the same, with its own exit code."""
    original_run = fake.run

    def run_to_the_rim(posed_images, *more):
        result = original_run(posed_images, *more)
        offset = result.points - posed_images.center
        offset *= posed_images.radius / np.linalg.norm(offset, axis=1, keepdims=True)
        result.points[:] = posed_images.center + offset
        result.view[:2] = -1
        return result

    monkeypatch.setattr(fake, "run", run_to_the_rim)
    code, text, errors = workspace.run()
    assert code == 3
    assert errors.startswith("error: the result is the region of interest and not the part: 100%")
    assert "33% are seen by no photograph" in errors
    assert f"{workspace.out}: 6 points" in text
    assert workspace.out.exists()
    assert not workspace.checkpoint.exists()


def test_a_piece_of_the_scene_is_no_result(workspace, monkeypatch):
    """Photographs of noise, of which the result covers nothing; masks would tell the outline."""
    rendered_whole = fake_pipeline.ReconstructionResult.render_views

    def render_nothing(self, *arguments):
        rendered = rendered_whole(self, *arguments)
        return replace(rendered, opacity=np.zeros_like(rendered.opacity))

    monkeypatch.setattr(fake_pipeline.ReconstructionResult, "render_views", render_nothing)
    code, text, errors = workspace.run("--method", "industnerf_plus")
    assert code == 3
    assert errors.startswith("error: the result is a piece of the scene and not the part: it")
    assert "covers 0% of what differs from the background in a photograph" in errors
    assert f"{workspace.out}: 2 points" in text
    assert workspace.run("--force", "--method", "industnerf")[0] == 0
    for path in (workspace.folder / "set/rgb").iterdir():
        with Image.open(path) as image:
            image.putalpha(Image.linear_gradient("L").resize(image.size))
            image.save(path)
    assert workspace.run("--force", "--method", "industnerf_plus")[0] == 0


def test_photographs_are_left_out_by_name(workspace, fake):
    code, text, _ = workspace.run("--exclude", "rgb/001.png", "003.PNG")
    assert (code, "2 of 5 frames are left out, as --exclude says" in text) == (0, True)
    np.testing.assert_array_equal(
        fake.LAST_CALL["posed_images"].rgb, sample_images.images()[[0, 2, 4]]
    )
    code, _, errors = workspace.run("--exclude", "9.png", "--force")
    assert (code, "--exclude 9.png: " in errors) == (2, True)


def test_scaled_results_are_in_millimeters(workspace):
    code, text, _ = workspace.run(
        *("--scale", "0,0,0", "-1,0,0", "10", "--mesh", workspace.folder / "mesh.stl")
    )
    assert (code, "in mm; in 1 piece" in " ".join(text.split())) == (0, True)
    assert b"comment lengths in mm\n" in workspace.out.read_bytes()


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("--sfm",), "either --cameras, or --sfm"),
        (("--mesh-pieces", "1"), "--mesh-pieces needs --mesh"),
        (("--scale", "a", "b", "0"), "0 is not above 0"),
        (("--scale", "a", "b", "c"), "'c' is no number"),
    ],
)
def test_options_that_do_not_fit_are_refused(workspace, arguments, complaint):
    code, _, errors = workspace.run(*arguments)
    assert (code, complaint in errors) == (2, True)


def test_a_method_that_needs_outlines_says_so_where_there_are_none(workspace):
    """The photographs are of noise, up to their borders."""
    words = "next to no photograph has a plain border, and there are no masks"
    assert words in workspace.run("--method", "industnerf_plus")[1]
    assert words not in workspace.run("--force")[1]
    assert (
        words
        not in workspace.run("--force", "--method", "industnerf_plus", "--background", "white")[1]
    )


def zipped(workspace, root="."):
    """The set as one archive, below the folder `root` in it."""
    path = workspace.folder / "photographs.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for file in sorted((workspace.folder / "set").rglob("*.*")):
            archive.write(file, Path(root) / file.relative_to(workspace.folder / "set"))
    return path


@pytest.mark.parametrize("root", [".", "project", "a/project"])
def test_an_archive_is_read_as_the_folder_that_it_holds(workspace, fake, root):
    workspace.run("--npz", "--out", workspace.folder / "of_folder.ply")
    archive = zipped(workspace, root)
    shutil.rmtree(workspace.folder / "set")
    code, _, errors = workspace.run("--npz", "--cameras", archive)
    assert (code, errors) == (0, "")
    np.testing.assert_array_equal(fake.LAST_CALL["posed_images"].rgb, sample_images.images())
    assert workspace.out.read_bytes() == (workspace.folder / "of_folder.ply").read_bytes()
    paths = np.load(workspace.folder / "cloud.npz")["image_paths"]
    assert paths[2] == str(archive / "rgb/002.png")


def test_what_is_wrong_with_an_archive_is_said_of_it(workspace):
    (workspace.folder / "set/rgb/002.png").unlink()
    archive = zipped(workspace)
    code, text, _ = workspace.run("--cameras", archive)
    assert (code, "1 of 5 frames (rgb/002.png) have no photograph" in text) == (0, True)
    code, _, errors = workspace.run("--cameras", archive, "--force", "--strict")
    assert code == 2
    assert f"no such photograph in {archive}" in errors
    archive.write_bytes(archive.read_bytes().replace(b"PK\x01\x02", b"PK\x01\x07", 1))
    code, _, errors = workspace.run("--cameras", archive, "--force")
    assert (code, errors.startswith(f"error: {archive}: cannot be unpacked: ")) == (2, True)


def test_a_damaged_archive_is_refused(workspace):
    """Whatever the decompressor raises."""
    path = zipped(workspace)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("transforms.json", "camera " * 5000)
    content = bytearray(path.read_bytes())
    content[50:60] = b"\xff" * 10
    path.write_bytes(content)
    code, _, errors = workspace.run("--cameras", path)
    assert (code, errors.startswith(f"error: {path}: cannot be unpacked: ")) == (2, True)


def test_arrays_of_numpy_are_no_archive(workspace):
    np.savez(workspace.folder / "cameras_sphere.npz", scale_mat_0=np.eye(4), world_mat_0=np.eye(4))
    code, _, errors = workspace.run("--cameras", workspace.folder / "cameras_sphere.npz")
    assert (code, "cameras_sphere.npz" in errors, "NeuS" in errors) == (2, True, True)


def test_an_archive_is_an_input_that_is_not_overwritten(workspace):
    archive = zipped(workspace).rename(workspace.folder / "cloud.ply")
    code, _, errors = workspace.run("--cameras", archive, "--force")
    assert (code, "is an input of this run" in errors) == (2, True)
