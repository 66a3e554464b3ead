"""Which values are drawn: distributions against SciPy's, and rows that never depend on which of them are asked for."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats

from cagepose.files.schema_study import DistributionModel, SampleModel
from cagepose.files.study_file import VariedKey
from cagepose.sampling.distribution import Distribution, distribution_of
from cagepose.sampling.sample import Sample


def distribution(nominal: float = 0.0, **content: object) -> Distribution:
    return distribution_of(VariedKey("key", ("key",), DistributionModel.model_validate(content), nominal))


def test_values_are_the_quantiles_of_the_distribution() -> None:
    shares = np.linspace(0.0, 1.0, 2001)[:-1]
    for found, expected in (
        (distribution(uniform=[-2.0, 3.0]), stats.uniform(-2.0, 5.0)),
        (distribution(normal={"sigma": 0.3, "mean": 1.0, "cut": 2.0}), stats.truncnorm(-2.0, 2.0, 1.0, 0.3)),
        (distribution(7.0, normal={"sigma": 0.3, "cut": 0.5}), stats.truncnorm(-0.5, 0.5, 7.0, 0.3)),
        (distribution(triangular=[1.0, 1.5, 4.0]), stats.triang(0.5 / 3.0, 1.0, 3.0)),
        (distribution(triangular=[1.0, 1.0, 4.0]), stats.triang(0.0, 1.0, 3.0)),
        (distribution(triangular=[1.0, 4.0, 4.0]), stats.triang(1.0, 1.0, 3.0)),
    ):
        assert found.values(shares) == pytest.approx(expected.ppf(shares), abs=1e-9)
        assert (found.mean, found.sigma) == pytest.approx((expected.mean(), expected.std()))
        assert (found.low, found.high) == pytest.approx(expected.support())
        assert found.values(shares).min() >= found.low
        assert found.values(shares).max() <= found.high


def test_a_normal_distribution_without_a_cut_is_never_infinite() -> None:
    found = distribution(2.0, normal={"sigma": 0.5})
    shares = np.array([0.0, 1e-6, 0.5, 1.0 - 1e-6])
    assert found.values(shares)[1:] == pytest.approx(stats.norm(2.0, 0.5).ppf(shares[1:]))
    assert np.isfinite(found.values(shares)).all()
    assert (found.low, found.high, found.sigma) == (0.5, 3.5, 0.5)


def test_listed_values_are_equally_likely() -> None:
    found = distribution(grid=[3.0, -1.0, 5.0])
    values, counts = np.unique(found.values(np.linspace(0.0, 1.0, 300, endpoint=False)), return_counts=True)
    assert values.tolist() == [-1.0, 3.0, 5.0]
    assert counts.tolist() == [100, 100, 100]
    steps = distribution(steps={"first": 0.0, "last": 1.0, "count": 5})
    assert steps.numbers == (0.0, 0.25, 0.5, 0.75, 1.0)
    assert steps.sigma == pytest.approx(math.sqrt(0.125))


@pytest.mark.parametrize("method", ["sobol", "latin hypercube", "random", "grid"])
def test_a_row_is_the_same_whichever_rows_are_asked_for(method: str) -> None:
    spreads = [distribution(steps={"first": 0.0, "last": 1.0, "count": 10}), distribution(uniform=[0.0, 1.0])]
    runs = {} if method == "grid" else {"runs": 1000}
    if method == "grid":
        spreads = [spreads[0], spreads[0], distribution(grid=[1.0, 2.0, 3.0])]
    model = SampleModel.model_validate({"method": method, "seed": 5, **runs})
    n_runs = 300 if method == "grid" else 1000
    whole = Sample(model, spreads)
    assert whole.n_runs == n_runs
    expected = whole.values(0, n_runs)
    again = Sample(model, spreads)
    for first, last in ((256, 300), (10, 20), (0, 256), (255, 257), (299, 300)):
        assert np.array_equal(again.values(first, last), expected[first:last])
    other = Sample(SampleModel.model_validate({"method": method, "seed": 6, **runs}), spreads)
    assert np.array_equal(other.values(0, n_runs), expected) == (method == "grid")


def test_a_grid_is_every_combination_once() -> None:
    spreads = [distribution(grid=[1.0, 2.0]), distribution(steps={"first": 0.0, "last": 1.0, "count": 3})]
    rows = Sample(SampleModel(method="grid"), spreads).values(0, 6)
    assert sorted(map(tuple, rows.tolist())) == [(a, b) for a in (1.0, 2.0) for b in (0.0, 0.5, 1.0)]


def test_a_grid_of_too_many_combinations_is_refused() -> None:
    steps = distribution(steps={"first": 0.0, "last": 1.0, "count": 100_000})
    with pytest.raises(ValueError, match="has 10000000000 combinations; give grids of at most"):
        Sample(SampleModel(method="grid"), [steps, steps])
