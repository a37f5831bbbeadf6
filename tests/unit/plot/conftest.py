from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.text import Text

from petalfoil.results.dataset import curve_dataset, to_dataset
from tests.unit.results import factory


@pytest.fixture
def flat() -> xr.Dataset:
    return to_dataset(factory.solved())


@pytest.fixture
def touching() -> xr.Dataset:
    return to_dataset(factory.solved(touching=True))


@pytest.fixture
def spatial() -> xr.Dataset:
    return to_dataset(factory.solved(nz=9, touching=True))


@pytest.fixture
def plain() -> xr.Dataset:
    return to_dataset(factory.plain())


@pytest.fixture
def curve() -> xr.Dataset:
    return curve_dataset(factory.curve())


@pytest.fixture
def static() -> xr.Dataset:
    return curve_dataset([factory.at_rest(e) for e in (0.0, 5e-5, 1e-4)], analysis="static")


@pytest.fixture
def checked() -> xr.Dataset:
    return to_dataset(factory.checked())


@pytest.fixture
def unconverged(flat: xr.Dataset) -> xr.Dataset:
    """A state whose fields are there although it did not converge, as a careless caller might hand over."""
    return flat.assign(converged=((), np.False_), status=((), "the step length fell below its limit"))


@pytest.fixture
def texts() -> Callable[[Figure], str]:
    """Everything a figure says, drawn once so that late errors of matplotlib show."""

    def collect(fig: Figure) -> str:
        fig.draw_without_rendering()
        return "\n".join(artist.get_text() for artist in fig.findobj(Text))

    return collect
