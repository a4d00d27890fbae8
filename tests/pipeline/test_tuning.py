"""Tuning: one method, on development parts, by what the tables call `x floor`."""

import sys

import pytest

from industnerf.config import load_params
from industnerf.errors import BadParams
from pipeline import tuning
from pipeline.tuning import check_tuning, objective
from tests.conftest import ROOT
from tests.pipeline.conftest import SMALL, Project

TEST_PART, DEV_PART = "enclosure-120x80x40", "nut-square-din557-m12"


@pytest.fixture
def tuned(monkeypatch):
    """Parameters of one method on one dev part, where Optuna is installed."""
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(tuning, "find_spec", lambda name: object())

    def params(select=(DEV_PART,), methods=("hull",), **sections):
        values = load_params(ROOT / "params.yaml")
        changes = {"select": list(select), **sections.get("parts", {})}
        object.__setattr__(values, "methods", list(methods))
        for name, section in {"parts": changes, "split": sections.get("split", {})}.items():
            for key, value in section.items():
                object.__setattr__(getattr(values, name), key, value)
        return values

    return params


def test_a_method_on_dev_parts_is_tuned(tuned):
    check_tuning([tuned(), tuned(methods=["carve"])])


def test_other_parts_methods_and_splits_are_refused(tuned):
    refused = {
        f"parts.select: {TEST_PART} are of the split test": tuned([DEV_PART, TEST_PART]),
        "and 91 more are of the split test": tuned([]),
        "parts of your own are all of the split test": tuned(parts={"source": "path"}),
        "methods are ['hull', 'carve']: 'methods=[hull]'": tuned(methods=["hull", "carve"]),
        "leave out split.*": tuned(split={"dev_fraction": 0.9}),
    }
    for message, params in refused.items():
        with pytest.raises(BadParams) as refusal:
            check_tuning([tuned(), params])
        assert message in str(refusal.value)


def test_without_optuna_its_extra_is_named(monkeypatch):
    monkeypatch.setattr(tuning, "find_spec", lambda name: None)
    with pytest.raises(BadParams, match=r"pip install -e '\.\[tune\]'"):
        check_tuning([])


def test_the_objective_is_the_ratio_to_the_floor_of_one_method_on_dev_parts(tmp_path):
    (tmp_path / "reports").mkdir()
    rows = {"dev": "hull,dev,1.5\n", "two": "hull,dev,1.5\nbox,dev,9\n", "test": "hull,test,1.5\n"}
    found = {}
    for name, text in rows.items():
        table = tmp_path / "reports/table1.csv"
        table.write_text(f"method,split,ratio_to_floor\n{text}")
        found[name] = objective(tmp_path)
    assert found == {"dev": 1.5, "two": None, "test": None}


@pytest.mark.parametrize(
    ("swept", "kind", "ends"),
    [
        ("interval(0,1)", "FloatDistribution(high=1.0, log=False, low=0.0, step=None)", (0.0, 1.0)),
        ("tag(log,interval(1e-3,1))", "FloatDistribution(high=1.0, log=True", (0.001, 1.0)),
        ("int(interval(2,8))", "IntDistribution(high=8, log=False, low=2, step=1)", (2, 8)),
        ("range(8,41,8)", "IntDistribution(high=40, log=False, low=8, step=8)", ("8", "40")),
        ("8,16", "CategoricalDistribution(choices=('8', '16'))", ("8", "16")),
        ("choice(a,b)", "CategoricalDistribution(choices=('a', 'b'))", ("a", "b")),
    ],
)
def test_a_sweep_is_a_distribution(swept, kind, ends):
    pytest.importorskip("optuna")
    from hydra_plugins.optuna_sweeper import distribution, extreme_points, split_overrides

    fixed, overrides = split_overrides([f"views.count={swept}", "seed=1"])
    assert fixed == ["seed=1"]
    assert str(distribution(overrides["views.count"])).startswith(kind)
    points = extreme_points([f"views.count={swept}", "seed=1"])
    assert points == [["seed=1", f"views.count={end}"] for end in ends]


@pytest.mark.slow
def test_trials_are_points_and_the_best_is_kept(root, tmp_path):
    pytest.importorskip("optuna")
    project = Project(root, tmp_path / "project")
    code, output = project.run(
        *(sys.executable, "-m", "pipeline.sweep", "-m", "hydra/sweeper=optuna", *SMALL),
        *("methods=[hull]", f"parts.select=[{DEV_PART}]", "hydra.sweeper.n_trials=3"),
        "method.hull.points=int(interval(1024,2048))",
    )
    assert code == 0, output
    assert [f"trial {i} of 3" in output for i in range(3)] == [True] * 3
    (folder,) = (project.folder / "runs" / "sweeps").iterdir()
    best = (folder / "optimization_results.yaml").read_text()
    assert "method.hull.points" in best
    assert len((folder / "sweep.csv").read_text().splitlines()) == 4
