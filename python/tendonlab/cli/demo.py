"""The data that come with the package, and the demonstration on them."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from tendonlab.errors import DatasetError

if TYPE_CHECKING:
    from tendonlab.report.diagnosis import Diagnosis

NAME = "two_inertia"


def bundled(name: str = NAME) -> Path:
    """Folder of a dataset that the package carries: "two_inertia", a synthetic rig whose simulator lacks one effect.

    Raises DatasetError where the package carries none of that name."""
    root = files("tendonlab").joinpath("bundled")
    datasets = (item for item in root.iterdir() if item.joinpath("dataset.toml").is_file()) if root.is_dir() else ()
    names = sorted(item.name for item in datasets)
    if name not in names:
        known = f"expected one of {', '.join(names)}" if names else "this installation has none; reinstall it"
        raise DatasetError(f"bundled dataset {name!r}: {known}")
    return Path(str(root.joinpath(name)))


def demo(out: str | Path = "tendonlab-demo", *, seed: int = 0, progress: bool = True) -> Diagnosis:
    """Diagnose the bundled rig and write its report and figures into the folder `out`."""
    from tendonlab.data import load
    from tendonlab.diagnosis.diagnose import diagnose
    from tendonlab.report.write import prepare_folder

    folder = prepare_folder(out)
    diagnosis = diagnose(load(bundled()), seed=seed, progress=progress)
    diagnosis.report(folder)
    return diagnosis
