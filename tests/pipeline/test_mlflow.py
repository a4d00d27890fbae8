"""What MLflow is given of the nets, as the pipeline gives it: how they learned, and an example."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from scipy.ndimage import binary_dilation

from industnerf.artifacts.cloud import Cloud
from industnerf.artifacts.history import History
from industnerf.artifacts.views import Views, load_views
from industnerf.geometry.cameras import project
from tests.pipeline.conftest import SMALL, Project

pytestmark = pytest.mark.slow  # runs whole pipelines

NETS = ("atlasnet", "occupancy", "r2n2")
STEPS = 12  # the net of a fold learns from one part, in so few steps next to nothing
TRAINING_OVERRIDES = {"max_steps": STEPS, "batch_size": 2, "val_interval": 4}
OVERRIDES = [
    f"method.{net}.training.{key}={value}"
    for net in NETS
    for key, value in TRAINING_OVERRIDES.items()
]
READ = """
import json, sys, mlflow
mlflow.set_tracking_uri(f"sqlite:///{sys.argv[1]}/mlflow.db")
points = mlflow.search_runs(
    experiment_names=["industnerf"], filter_string="tags.kind = 'point'", output_format="list"
)
client, found = mlflow.MlflowClient(), {}
for run in points:
    images = mlflow.artifacts.download_artifacts(f"{run.info.artifact_uri}/images")
    found[run.data.params["method"]] = {"images": images} | {
        name: [(one.step, one.value) for one in client.get_metric_history(run.info.run_id, name)]
        for name in run.data.metrics if name.startswith("loss/")
    }
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def logged(tmp_path_factory, finished_run) -> tuple[Path, dict]:
    """The data of a study of three nets, and what MLflow has of it."""
    project = Project(Path(__file__).parents[2], tmp_path_factory.mktemp("nets") / "project")
    mlflow = str(project.folder / "mlflow")
    project.environment |= {
        "INDUSTNERF_STORE": str(finished_run.folder / "store"),
        "INDUSTNERF_MLFLOW": mlflow,
        "INDUSTNERF_RUNNER": "serial",  # torch is imported once
    }
    methods = f"methods=[{','.join(NETS)}]"
    sweep = ("python", "-m", "pipeline.sweep", "--multirun")
    code, output = project.run(*sweep, *SMALL, methods, *OVERRIDES)
    assert code == 0, output
    sweep_output = output
    code, output = project.run("python", "-c", READ, mlflow)
    assert code == 0, sweep_output + output
    (data,) = project.folder.glob("runs/sweeps/*/*/data")
    return data, json.loads(output.splitlines()[-1])


def mean_curve(folders: list[Path]) -> list[tuple[int, float]]:
    """The mean of the losses that are kept in `folders`, step by step."""
    histories = [History.load(folder) for folder in folders]
    assert len(histories) == 2  # a net for each of the two parts, which the other one taught
    return list(
        zip(
            histories[0].steps,
            np.mean([history.loss for history in histories], axis=0),
            strict=True,
        )
    )


@pytest.mark.parametrize("net", NETS)
def test_a_nets_curves_are_those_that_its_training_kept(logged, net):
    data, logged_runs = logged
    folds = sorted((data / "states" / net).glob("fold-*"))
    losses = mean_curve(folds)
    assert [step for step, _ in losses] == list(range(STEPS))
    assert np.isfinite([loss for _, loss in losses]).all()
    # as sums of two floats, in either order, they are exact
    assert logged_runs[net]["loss/training"] == [list(one) for one in losses]
    validated = mean_curve([fold / "validation" for fold in folds])
    assert len(validated) >= STEPS // TRAINING_OVERRIDES["val_interval"]
    assert logged_runs[net]["loss/validation"] == [list(one) for one in validated]


def point_footprint(cloud: Path, views: Views, camera: int) -> np.ndarray:
    """The pixels of a camera in which a point of the cloud lies, and those beside them.

    The points of these nets are gray: before white none is missed.
    """
    points, cameras = Cloud.load(cloud).points_mm, views.cameras
    uv, _ = project(points, cameras.K[camera], cameras.c2w[camera])
    column, row = np.floor(uv).astype(int).T + 1  # of a picture with a margin all round
    height, width = cameras.height + 2, cameras.width + 2
    is_inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    footprint = np.zeros((height, width), bool)
    footprint[row[is_inside], column[is_inside]] = True
    assert footprint.any()
    return binary_dilation(footprint, np.ones((3, 3)))[1:-1, 1:-1]


@pytest.mark.parametrize("net", NETS)
def test_a_nets_picture_has_a_row_a_part_the_photograph_beside_what_was_made_of_it(logged, net):
    data, logged_runs = logged
    (path,) = Path(logged_runs[net]["images"]).glob("preview*.png")
    preview = np.asarray(Image.open(path).convert("RGB"))
    parts = sorted(path.name for path in (data / "clouds" / net).glob("*/"))
    rows = np.split(preview, len(parts))
    assert len(parts) == 2
    for part, row in zip(parts, rows, strict=True):
        views = load_views(data / "views" / part)
        image, example = np.split(row, 2, axis=1)
        camera = int(np.flatnonzero(views.held_out)[0])
        np.testing.assert_array_equal(image, views.rgb(np.array([camera]))[0])
        is_drawn = (example != 255).any(axis=2)
        np.testing.assert_array_equal(
            is_drawn, point_footprint(data / "clouds" / net / part, views, camera)
        )
