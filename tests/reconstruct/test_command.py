"""The command as a user gives it, over a stand-in for the method."""

import json
import os
import signal
import subprocess
import sys

import numpy as np
import pytest
import torch
import trimesh
from PIL import Image

from industnerf.artifacts import whole
from industnerf.geometry.cameras import framed_ball
from industnerf.seeds import seed_for
from tests.reconstruct import scene

ALWAYS = 1e-9  # seconds: due whenever asked


def ctrl_c():
    os.kill(os.getpid(), signal.SIGINT)


def test_the_cloud_is_in_the_cameras_frame_and_unit(desk, fake):
    code, text, errors = desk.run("--npz")
    assert (code, errors) == (0, "")
    assert f"{desk.out}: 6 points, 6 steps, 4 parameters; " in text
    assert "MB" in text
    cloud = np.load(desk.folder / "cloud.npz")
    read = trimesh.load(desk.out)
    np.testing.assert_array_equal(read.vertices, cloud["points"])
    np.testing.assert_array_equal(read.colors[:, :3], cloud["colours"])
    centre, radius = framed_ball(scene.cameras())
    assert (np.abs(cloud["points"] - centre) <= radius * (1 + 1e-6)).all()  # float32
    assert [path.split("/")[-1] for path in cloud["photos"]] == [f"{i:03d}.png" for i in range(5)]
    assert desk.files() == {"set", "params.yaml", "cloud.ply", "cloud.npz"}


def test_the_ply_says_what_it_holds(desk):
    desk.run()
    header, _, body = desk.out.read_bytes().partition(b"end_header\n")
    properties = [line[9:] for line in header.decode().splitlines() if line.startswith("property")]
    assert properties == [
        *("float x", "float y", "float z", "uchar red", "uchar green", "uchar blue"),
        *("float confidence", "float quality", "short view"),
    ]
    assert len(body) == 6 * (3 * 4 + 3 + 2 * 4 + 2)


@pytest.mark.parametrize("word", ["white", "White", "WHITE", "#FFFFFF"])
def test_a_colour_is_one_however_it_is_written(desk, fake, word):
    desk.run("--background", word)
    np.testing.assert_array_equal(fake.SEEN["posed"].background, np.ones((5, 3)))


def test_the_method_gets_what_the_user_gave(desk, fake):
    desk.run("--set", "method.industnerf.rate=2e-3", "seed=9", "--background", "#0000ff")
    posed = fake.SEEN["posed"]
    np.testing.assert_array_equal(posed.rgb, scene.photographs())
    np.testing.assert_array_equal(posed.background, [[0, 0, 1]] * 5)
    assert (fake.SEEN["settings"].rate, fake.SEEN["settings"].steps) == (2e-3, 6)
    assert fake.SEEN["seed"] == seed_for(9, "reconstruct", "industnerf")
    desk.run("--force", "--method", "industnerf_plus", "--centre", 9, -4, 3, "--radius", 0.5)
    assert fake.SEEN["settings"].steps == 2
    assert fake.SEEN["posed"].background is None
    assert (fake.SEEN["posed"].centre.tolist(), fake.SEEN["posed"].radius) == ([9, -4, 3], 0.5)


@pytest.mark.parametrize("y", ["-4", "-4.", "-4e0", "-.4E+1"])
def test_a_centre_may_be_negative_however_it_is_written(desk, fake, y):
    """The command itself says -2.3e-05."""
    code, *_ = desk.run("--centre", 9, y, 3, "--radius", 0.5)
    assert code == 0
    assert fake.SEEN["posed"].centre.tolist() == [9, -4, 3]


def test_images_may_lie_elsewhere(desk, fake):
    (desk.folder / "set/rgb").rename(desk.folder / "photos")
    code, *_ = desk.run("--images", desk.folder / "photos")
    assert code == 0
    np.testing.assert_array_equal(fake.SEEN["posed"].rgb, scene.photographs())


@pytest.mark.parametrize(
    ("name", "complaint"),
    [
        ("none", "does not exist"),
        ("params.yaml", "is no folder"),
        ("empty", "none of the 5 photographs is found there, the first is "),
        ("others", "none of the 5 photographs is found there"),
    ],
)
def test_a_folder_that_was_named_is_not_passed_over(desk, fake, name, complaint):
    """Though all photographs are beside the cameras."""
    (desk.folder / "empty").mkdir()
    (desk.folder / "others").mkdir()
    (desk.folder / "others/7.png").touch()
    code, _, errors = desk.run("--images", desk.folder / name)
    assert (code, f"--images {desk.folder / name}: {complaint}" in errors) == (2, True)
    assert fake.SEEN == {}


def test_photographs_from_beside_the_cameras_are_counted(desk, fake):
    """The folder has three; what it goes before is no stranger."""
    (desk.folder / "photos").mkdir()
    for i in range(3):
        flat = np.full((scene.HEIGHT, scene.WIDTH, 3), i, np.uint8)
        Image.fromarray(flat).save(desk.folder / f"photos/{i:03d}.png")
    code, text, _ = desk.run("--images", desk.folder / "photos")
    assert code == 0
    said = " ".join(text.split())
    assert f"2 of 5 photographs are not in --images {desk.folder / 'photos'}: taken from" in said
    assert f"the first as {desk.folder / 'set/rgb/003.png'}" in said
    assert "no frame names" not in said
    assert fake.SEEN["posed"].rgb[:, 0, 0, 0].tolist()[:3] == [0, 1, 2]


def test_settings_are_shown_on_request(desk):
    _, text, _ = desk.run("--show", "--set", "method.industnerf.reading=printed")
    for line in (
        'method.industnerf.reading = "printed"',
        "method.industnerf.steps = 6",
        "seed = 3",
    ):
        assert line in text


def test_an_interrupted_run_goes_on_to_the_same_bytes(desk, fake):
    desk.run("--out", desk.folder / "whole.ply")
    fake.AT[3] = ctrl_c
    code, text, errors = desk.run()
    assert code == 130
    assert f"the same command goes on from {desk.checkpoint}" in errors
    assert not desk.out.exists()
    fake.AT.clear()
    code, text, _ = desk.run()
    assert code == 0
    assert f"going on from {desk.checkpoint}" in text
    assert len(fake.SEEN["resume"]["points"]) == 4  # the step that was under way was finished
    assert desk.out.read_bytes() == (desk.folder / "whole.ply").read_bytes()
    assert not desk.checkpoint.exists()


def test_a_second_ctrl_c_ends_at_once_and_keeps_the_last_checkpoint(desk, fake):
    fake.AT[3] = lambda: (ctrl_c(), ctrl_c())
    code, *_ = desk.run("--checkpoint-every", ALWAYS)
    assert (code, desk.checkpoint.exists()) == (130, True)
    fake.AT.clear()
    desk.run()
    assert len(fake.SEEN["resume"]["points"]) == 3


def test_an_interrupted_fresh_start_goes_on_without_fresh(desk, fake):
    """With it, the same command would drop what was just kept."""
    fake.AT[3] = ctrl_c
    code, _, errors = desk.run("--fresh")
    assert code == 130
    assert f"the same command without --fresh goes on from {desk.checkpoint}" in errors
    fake.AT.clear()
    desk.run()
    assert len(fake.SEEN["resume"]["points"]) == 4


def test_an_early_ctrl_c_keeps_nothing_and_says_so(desk, fake):
    fake.AT[0] = lambda: (ctrl_c(), ctrl_c())
    code, _, errors = desk.run()
    assert (code, errors) == (130, "interrupted; nothing of this run is kept\n")
    assert desk.files() == {"set", "params.yaml"}


def test_what_an_earlier_run_kept_is_not_taken_for_this_ones(desk, fake):
    """With --fresh it is dropped, and belongs to another run."""
    fake.AT[3] = ctrl_c
    assert desk.run()[0] == 130
    os.utime(desk.checkpoint, (0, 0))
    fake.AT.clear()
    fake.AT[0] = lambda: (ctrl_c(), ctrl_c())
    code, _, errors = desk.run("--fresh")
    assert (code, errors) == (130, "interrupted; nothing of this run is kept\n")


def crash():
    raise RuntimeError("as if the power went")


def stopped(desk, fake, *arguments):
    """Leaves a checkpoint behind."""
    fake.AT[3] = crash
    with pytest.raises(RuntimeError, match="power"):
        desk.run("--checkpoint-every", ALWAYS, *arguments)
    fake.AT.clear()
    assert desk.checkpoint.exists()


def test_checkpoints_outlive_a_crash(desk, fake):
    stopped(desk, fake)
    assert desk.run()[0] == 0
    assert len(fake.SEEN["resume"]["points"]) == 3


def test_nought_seconds_mean_never(desk, fake):
    fake.AT[3] = crash
    with pytest.raises(RuntimeError, match="power"):
        desk.run("--checkpoint-every", 0, "--preview-every", 0)
    assert desk.files() == {"set", "params.yaml"}


def test_a_fresh_start_forgets_at_once(desk, fake):
    """Else a crash before its first checkpoint would let the dropped run go on."""
    stopped(desk, fake)
    fake.AT[0] = crash
    with pytest.raises(RuntimeError, match="power"):
        desk.run("--fresh")
    assert not desk.checkpoint.exists()


def change_photo(desk):
    Image.fromarray(scene.photographs()[0]).save(desk.folder / "set/rgb/004.png")


def change_camera(desk):
    said = json.loads(desk.transforms.read_text())
    scene.rewrite(desk.transforms, said | {"fl_x": 61.0})


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
def test_a_checkpoint_of_other_inputs_is_refused(desk, fake, change, arguments, differs):
    stopped(desk, fake)
    if change:
        change(desk)
    code, _, errors = desk.run(*arguments)
    assert code == 2
    assert differs in errors
    assert "--fresh" in errors
    assert desk.run("--fresh", *arguments)[0] == 0
    assert fake.SEEN["resume"] is None
    assert not desk.checkpoint.exists()


def test_a_checkpoint_of_another_kind_of_device_is_refused(desk, fake, monkeypatch):
    """There roundings sort other points out than those whose numbers it holds."""
    stopped(desk, fake)
    monkeypatch.setattr("industnerf.reconstruct.origin.device", lambda: torch.device("meta"))
    code, _, errors = desk.run()
    assert (code, "another run: device differ" in errors) == (2, True)


def test_a_torn_checkpoint_is_refused(desk, fake):
    stopped(desk, fake)
    desk.checkpoint.write_bytes(desk.checkpoint.read_bytes()[:-9])
    code, _, errors = desk.run()
    assert (code, "is torn" in errors) == (2, True)
    assert desk.run("--fresh")[0] == 0


def test_a_file_that_is_no_checkpoint_is_never_replaced(desk):
    photo = desk.folder / "mine.png"
    Image.fromarray(scene.photographs()[0]).save(photo)
    before = photo.read_bytes()
    for extra in ((), ("--fresh",)):
        code, _, errors = desk.run("--checkpoint", photo, *extra)
        assert (code, "is there and is no checkpoint" in errors) == (2, True)
    assert photo.read_bytes() == before


@pytest.mark.parametrize("name", ["cloud.ply", "cloud.npz", "mine.png", "mesh.stl"])
def test_what_is_there_stays_unless_forced(desk, fake, name):
    (desk.folder / name).write_text("dear")
    arguments = ("--mesh", desk.folder / "mesh.stl")
    arguments += ("--npz", "--preview", desk.folder / "mine.png", "--preview-every", ALWAYS)
    code, _, errors = desk.run(*arguments)
    assert (code, f"{name} is there already; --force" in errors) == (2, True)
    assert (desk.folder / name).read_text() == "dear"
    assert fake.SEEN == {}
    assert desk.run("--force", *arguments)[0] == 0
    assert not (desk.folder / name).read_bytes().startswith(b"dear")


def test_a_run_that_goes_on_may_renew_its_preview(desk, fake):
    arguments = ("--preview", desk.folder / "mine.png", "--preview-every", ALWAYS)
    stopped(desk, fake, *arguments)
    assert (desk.folder / "mine.png").exists()
    assert desk.run(*arguments)[0] == 0


def test_a_fresh_start_has_no_preview_of_its_own(desk, fake):
    stopped(desk, fake, "--preview-every", 0)
    (desk.folder / "mine.png").write_text("dear")
    arguments = ("--fresh", "--preview", desk.folder / "mine.png", "--preview-every", ALWAYS)
    code, _, errors = desk.run(*arguments)
    assert (code, "mine.png is there already; --force" in errors) == (2, True)
    assert (desk.folder / "mine.png").read_text() == "dear"
    assert desk.checkpoint.exists()
    assert desk.run("--force", *arguments)[0] == 0


@pytest.mark.parametrize("option", ["--out", "--checkpoint", "--preview", "--mesh"])
def test_a_folder_is_refused_before_any_work(desk, fake, option):
    (desk.folder / "mine.ply").mkdir()
    for extra in ((), ("--force",)):
        code, _, errors = desk.run(option, desk.folder / "mine.ply", *extra)
        assert (code, "mine.ply: is a folder" in errors) == (2, True)
    assert fake.SEEN == {}


@pytest.mark.parametrize("option", ["--out", "--checkpoint", "--preview", "--mesh"])
@pytest.mark.parametrize("said", ["shared", "held out", "cameras", "settings", "a link"])
def test_an_input_is_never_overwritten(desk, fake, option, said):
    """Each is given a name that the option takes, which may be a link to it."""
    scene.rewrite(
        desk.transforms,
        json.loads(desk.transforms.read_text())
        | {"train_filenames": [f"rgb/{i:03d}.png" for i in range(4)]},
    )
    files = {
        "shared": desk.folder / "set/rgb/000.png",
        "held out": desk.folder / "set/rgb/004.png",
        "cameras": desk.transforms,
        "settings": desk.folder / "params.yaml",
        "a link": desk.folder / "set/rgb/000.png",
    }
    name = desk.folder / "mine.ply"
    (name.hardlink_to if said == "a link" else name.symlink_to)(files[said])
    before = files[said].read_bytes()
    code, _, errors = desk.run(option, name, "--force")
    assert (code, f"{option} {name}: is an input of this run" in errors) == (2, True)
    assert files[said].read_bytes() == before
    assert fake.SEEN == {}


def test_one_file_cannot_be_two(desk):
    code, _, errors = desk.run("--checkpoint", desk.out)
    assert (code, "must be different files" in errors) == (2, True)


def test_a_preview_shows_photograph_and_rendering(desk):
    desk.run("--preview-every", ALWAYS)
    with Image.open(f"{desk.out}.preview.png") as image:
        shown = np.asarray(image)
    source = scene.photographs()[0]
    np.testing.assert_array_equal(shown[:, : scene.WIDTH], source)
    np.testing.assert_array_equal(shown[:, -scene.WIDTH :], 255 - source)


def test_a_run_goes_on_without_what_cannot_be_written(desk, fake, monkeypatch):
    """A disk that is full while the run lasts, and has room again at its end."""

    def full(descriptor):
        raise OSError(28, "No space left on device")

    def fill():
        monkeypatch.setattr(whole.os, "fsync", full)

    fake.AT.update({2: fill, 5: monkeypatch.undo})
    arguments = ("--checkpoint-every", ALWAYS, "--preview-every", ALWAYS)
    code, text, _ = desk.run(*arguments)
    assert code == 0
    assert text.count("going on without: ") == 2 * 3
    assert "No space left on device" in text


def test_no_surface_is_a_failure_and_no_users_error(desk):
    code, _, errors = desk.run("--set", "method.industnerf.steps=0")
    assert code == 1
    assert errors.startswith("error: the method found no surface")
    assert not desk.out.exists()


def test_points_that_are_not_finite_are_a_failure(desk, fake, monkeypatch):
    whole_run = fake.run

    def torn(*given):
        outcome = whole_run(*given)
        outcome.points[2:4, 1] = np.nan
        return outcome

    monkeypatch.setattr(fake, "run", torn)
    code, _, errors = desk.run()
    assert (code, errors) == (1, "error: not finite: 2 of 6 points\n")


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("--out", "cloud.obj"), "must end in .ply"),
        (("--mesh", "part.step"), "must end in .stl, .ply or .obj"),
        (("--centre", "1", "2", "3"), "--centre needs --radius"),
        (("--radius", "-1"), "-1 is not above 0"),
        (("--radius", "nan"), "'nan' is no number"),
        (("--max-size", "8"), "8 is no whole number of at least 16"),
        (("--background", "pink"), "'pink' is not white, grey, black or #rrggbb"),
        (("--checkpoint-every", "-1"), "-1 is below 0"),
        (("--method", "hull"), "invalid choice"),
        (("--set", "method.industnerf.step=1"), "method.industnerf.step is unknown"),
        (("--cameras", "none.json"), "none.json: cannot be read: No such file"),
        (("--images", "none", "--cameras", "none.json"), "none.json: cannot be read"),
    ],
)
def test_users_errors_are_one_sentence_and_code_2(desk, arguments, complaint):
    code, _, errors = desk.run(*arguments)
    assert code == 2
    assert complaint in errors
    assert "Traceback" not in errors
    assert "error: " in errors.splitlines()[-1]


def test_a_bad_photograph_is_named_with_its_frame(desk):
    photo = desk.folder / "set/rgb/002.png"
    photo.write_bytes(photo.read_bytes()[:300])
    code, _, errors = desk.run()
    assert code == 2
    assert errors.startswith(f"error: frame 2 (rgb/002.png): {photo} cannot be read as an image")


@pytest.mark.parametrize(
    "change", [{"fl_x": 10**400}, {"k4": [1, [2]]}, {"w": 48.9}, {"k1": 10**400}]
)
def test_a_camera_that_is_none_is_named(desk, change):
    said = json.loads(desk.transforms.read_text())
    said["frames"][2] |= change
    scene.rewrite(desk.transforms, said)
    code, _, errors = desk.run()
    assert (code, errors.startswith("error: frame 2 (rgb/002.png): ")) == (2, True)
    assert f"{next(iter(change))} " in errors


def test_a_photograph_without_a_camera_is_said_to_be_left_out(desk, fake):
    (desk.folder / "set/rgb/005.jpg").write_text("not even an image: nobody opens it")
    code, text, errors = desk.run()
    assert (code, errors) == (0, "")
    assert "images that no frame names, left out: 1 (005.jpg)\n" in text
    np.testing.assert_array_equal(fake.SEEN["posed"].rgb, scene.photographs())


def test_a_camera_without_a_photograph_is_an_error(desk):
    (desk.folder / "set/rgb/003.png").unlink()
    code, _, errors = desk.run()
    assert code == 2
    assert errors.startswith("error: frame 3 (rgb/003.png): no such photograph in ")


def test_help_needs_nothing_heavy(root):
    """In a process of its own, as the modules of this one are all there."""
    script = (
        "import runpy, sys\n"
        "sys.argv = ['x', '--help']\n"
        "try: runpy.run_module('industnerf.reconstruct', run_name='__main__')\n"
        "except SystemExit as end: assert not end.code\n"
        "print(sorted({'torch', 'numpy', 'PIL', 'scipy', 'omegaconf', 'rich'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=root)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "[]"
    assert "--cameras" in done.stdout


def test_the_local_file_says_where_to_compute_and_a_device_that_is_none_is_refused(
    desk, monkeypatch
):
    monkeypatch.setenv("INDUSTNERF_DEVICE", "")  # so that it is as before when the test is over
    monkeypatch.delenv("INDUSTNERF_DEVICE")
    monkeypatch.chdir(desk.folder)
    (desk.folder / ".industnerf.env").write_text("INDUSTNERF_DEVICE=gpu\n")
    code, _, errors = desk.run()
    assert code == 2
    assert "INDUSTNERF_DEVICE is 'gpu', must be cpu, cuda or cuda:N" in errors
