"""The ten-minute tour."""

from pathlib import Path

import pytest
from notebooks.execute import execute

from twin import TwinDiagnosis


@pytest.mark.cpu(25)
def test_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, twin_diagnosis: TwinDiagnosis) -> None:
    """The demo has diagnosed its rig already."""
    execute("start_here", tmp_path, monkeypatch)
