"""A case that is ready to fit: the bundled rig, prepared once."""

from typing import Any

import pytest

import tendonlab as tl
from tendonlab.cli.demo import bundled
from tendonlab.fitting.case import make_case


@pytest.fixture(scope="session")
def twin_case() -> Any:
    return make_case(tl.load(bundled()))
