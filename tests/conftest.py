"""Marks every test by its folder, and fixes what would make two runs differ."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from petalfoil.case import Case
from petalfoil.compiled import numba_is_installed
from petalfoil.equilibrium.run_context import RunContext, running
from petalfoil.walls import register, unregister
from tests.walls.elastic_foundation import ElasticFoundation

HERE = Path(__file__).parent
FOLDERS = ("unit", "contract", "verification", "validation", "regression", "docs", "studio")

settings.register_profile("petalfoil", derandomize=True, deadline=None, database=None)
settings.load_profile("petalfoil")


@pytest.fixture(autouse=True)
def run() -> Iterator[RunContext]:
    """Every test is a run of its own: none inherits counts or elimination orders."""
    with running() as context:
        yield context


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        folder = item.path.relative_to(HERE).parts[0] if item.path.is_relative_to(HERE) else ""
        if folder in FOLDERS:
            item.add_marker(getattr(pytest.mark, folder))
        if item.get_closest_marker("compiled") and not numba_is_installed():
            item.add_marker(pytest.mark.skip(reason="needs numba: too slow in NumPy (make test-classic)"))


@pytest.fixture(scope="module")
def foundation() -> Iterator[Case]:
    """A bearing on a wall that petalfoil does not have, registered while the tests of a module run."""
    kind = ElasticFoundation()
    register(kind)
    yield Case.load(HERE / "walls" / "elastic_foundation.toml")
    unregister(kind)
