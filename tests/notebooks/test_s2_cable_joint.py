"""The notebook of S2: it runs, and its table of differences from the paper is within the tolerances."""

from pathlib import Path

import pytest
from notebooks.execute import WITHIN, execute


@pytest.mark.slow
def test_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    execute("s2_cable_joint", tmp_path, monkeypatch, last=WITHIN)
