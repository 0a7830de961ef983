"""Four short cases, drawn once for all tests of the protocol."""

import pytest
from sealed_cases import Drawn

from tendonlab.blind import draw


@pytest.fixture(scope="session")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Drawn:
    """The truth lies outside of the folder that holds the cases, as `run` expects."""
    folder, sealed = tmp_path_factory.mktemp("blind"), tmp_path_factory.mktemp("apart") / "truth"
    draw(15, 4, folder, sealed=sealed, jobs=1, num_samples=120, step=2e-4, progress=False)
    return Drawn(folder / "cases", sealed)
