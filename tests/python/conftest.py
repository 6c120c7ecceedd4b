"""Small simulated data for the tests of the package."""

import pathlib

import numpy as np
import pytest

import mosbench


@pytest.fixture(scope="session")
def street(tmp_path_factory) -> pathlib.Path:
    """Twelve scans in the layout of SemanticKITTI."""
    return mosbench.simulate(tmp_path_factory.mktemp("data") / "street", scene="street", scans=12)


@pytest.fixture(scope="session")
def near() -> mosbench.Config:
    """Settings that make runs quick and still find something."""
    return mosbench.Config(voxel_size_m=0.4, max_range_m=20.0, min_otsu_score=1)


@pytest.fixture(scope="session")
def finished(street, near, tmp_path_factory) -> mosbench.Result:
    result = mosbench.run(street, config=near, out=tmp_path_factory.mktemp("runs") / "near", scores=True)
    assert result.per_scan["moving"].sum() > 0
    return result


@pytest.fixture
def wall() -> np.ndarray:
    """A wall of 400 points, float32 (N, 4)."""
    y, z = np.meshgrid(np.linspace(-2, 2, 20), np.linspace(-1, 1, 20))
    points = np.zeros((400, 4), dtype=np.float32)
    points[:, 0], points[:, 1], points[:, 2] = 4, y.ravel(), z.ravel()
    return points
