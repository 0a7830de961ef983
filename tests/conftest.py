"""What all tests share: no display, and the measured data where they lie beside the repository."""

import os
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

_MEASURED = Path(__file__).resolve().parents[2] / "shared" / "data"
if _MEASURED.is_dir():
    os.environ.setdefault("TENDONLAB_DATA", str(_MEASURED))
