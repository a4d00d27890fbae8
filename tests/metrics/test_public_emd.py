"""`from industnerf import emd`: the plan, the certificate, the refusals, and the page's example."""

import doctest
import re
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import industnerf
from industnerf import emd
from industnerf.errors import MetricError

SIZES = st.one_of(st.integers(1, 40), st.integers(370, 420))  # dense problems, and sparse ones


def cloud(n: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(n, 3))


@given(st.integers(0, 10**6), SIZES, SIZES, st.booleans())
@settings(max_examples=15)
def test_the_plan_carries_the_clouds_onto_each_other_at_the_value(seed, n, m, squared):
    a, b = cloud(n, seed), cloud(m, seed + 1)
    result = emd(a, b, squared=squared)
    row, column, mass = result.plan.row, result.plan.column, result.plan.mass
    # Rounding: the masses are of some 1/n, their sums of 1.
    np.testing.assert_allclose(np.bincount(row, mass, n), 1 / n, rtol=1e-14)
    np.testing.assert_allclose(np.bincount(column, mass, m), 1 / m, rtol=1e-14)
    assert mass.min() > 0
    assert len(mass) <= n + m - 1
    assert (np.diff(row * m + column) > 0).all()
    lengths = np.linalg.norm(a[row] - b[column], axis=1)
    assert mass @ lengths ** (2 if squared else 1) == pytest.approx(result.value, rel=1e-12)


@pytest.mark.parametrize("n", [30, 500])
def test_the_certificate_holds_the_truth(n):
    """A shift costs its length, whatever the plan."""
    a, shift = cloud(n, 1), np.array([0.6, 0.0, 0.8])
    result = emd(a, a + shift)
    assert result.lower_bound <= 1 + 1e-14  # rounding
    assert result.value >= 1 - 1e-14
    assert result.gap == pytest.approx(result.value - result.lower_bound, abs=1e-16)
    assert 0 <= result.gap <= 1e-9


def test_lists_and_other_numbers_will_do():
    assert emd([[0, 0, 0]], [[3, 0, 4]]).value == 5.0
    assert emd([[0, 0, 0]], np.array([[3, 0, 4]], np.float32), squared=True).value == 25.0


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (np.zeros((4, 2)), r"cloud 'b' has shape \(4, 2\); points must be \(n, 3\)"),
        (np.empty((0, 3)), "cloud 'b' is empty"),
        ([[0, 0, np.nan]], "cloud 'b' has 1 of 1 points that are not finite"),
        ("part.ply", "cloud 'b' is of <U8"),
    ],
)
def test_a_refusal_names_the_cloud_and_what_is_wrong(bad, message):
    with pytest.raises(MetricError, match=message):
        emd(cloud(4, 1), bad)


def test_weights_are_not_taken_for_something_else():
    with pytest.raises(TypeError, match="positional arguments"):
        emd(cloud(4, 1), cloud(4, 2), np.full(4, 0.25))
    with pytest.raises(TypeError, match="weights"):
        emd(cloud(4, 1), cloud(4, 2), weights=np.full(4, 0.25))


def test_the_package_is_loaded_without_any_numeric_library():
    code = (
        "import sys; import industnerf\n"
        "assert not {'numpy', 'scipy', 'ot', 'torch'} & set(sys.modules)\n"
        "from industnerf import emd\n"
        "assert not {'ot', 'torch', 'warp'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_what_the_package_has_not_it_says():
    with pytest.raises(AttributeError, match="'industnerf' has no attribute 'emdd'"):
        _ = industnerf.emdd


def test_the_example_of_the_page_prints_what_it_says(root):
    page = (root / "docs/api/metrics.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```pycon\n(.*?)```", page, re.DOTALL)
    test = doctest.DocTestParser().get_doctest(example, {}, "metrics.md", None, 0)
    assert doctest.DocTestRunner().run(test) == (0, len(test.examples))
    assert test.examples
