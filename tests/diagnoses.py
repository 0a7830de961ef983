"""Each diagnosis once per run of the tests, whoever asks for it: a test, the kernel of a notebook or the demo.

Results lie as pickles in the folder that the environment variable FOLDER names, by a digest of everything that they
depend on. A lock per result makes a second process wait for the first instead of computing the same."""

import fcntl
import hashlib
import inspect
import os
import pickle
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import tendonlab as tl
from budget import shared
from tendonlab.report.diagnosis import Diagnosis

FOLDER = "TENDONLAB_TEST_DIAGNOSES"
NO_MATTER = ("path", "progress")  # where a dataset lies and whether progress is shown
HOOK = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
import diagnoses
diagnoses.share()
"""

_compute = tl.diagnose


def diagnose(dataset: tl.Dataset, **options: Any) -> Diagnosis:
    """What `tl.diagnose` gives, without progress, computed once per run of the tests."""
    given = inspect.signature(_compute).bind(dataset, **options)
    given.apply_defaults()
    path = Path(os.environ[FOLDER]) / f"{digest(given.arguments)}.pickle"
    with _locked(path.with_suffix(".lock")):
        if not path.is_file():
            with shared():
                path.write_bytes(pickle.dumps(_compute(dataset, **{**options, "progress": False})))
    found: Diagnosis = pickle.loads(path.read_bytes())
    return found


def share() -> None:
    """Make every diagnosis of this process a shared one. HOOK does so in a process that does not know the tests."""
    from tendonlab.diagnosis import diagnose as module

    tl.diagnose = module.diagnose = diagnose


def digest(value: Any) -> str:
    """A name for values of equal content, the same in every process. Raises TypeError for a type that it cannot read,
    lest two different values get one name."""
    read = hashlib.sha256()
    for part in _parts(value):
        read.update(part)
    return read.hexdigest()


def _parts(value: Any) -> Iterator[bytes]:
    yield f"<{type(value).__name__}>".encode()
    if value is None or isinstance(value, str | bool | int | float | np.generic):
        yield repr(value).encode()
    elif isinstance(value, np.ndarray) and value.dtype != object:
        yield from (str(value.dtype).encode(), str(value.shape).encode(), value.tobytes())
    elif isinstance(value, pd.DataFrame):
        yield from _parts([*map(str, value.columns), value.index.to_numpy(), value.to_numpy()])
    elif is_dataclass(value):
        yield from _parts({field.name: getattr(value, field.name) for field in fields(value)})
    elif isinstance(value, Mapping):
        for key in (key for key in value if key not in NO_MATTER):
            yield from (*_parts(key), *_parts(value[key]))
    elif isinstance(value, Sequence):
        for item in value:
            yield from _parts(item)
    else:
        raise TypeError(f"{type(value).__name__}: no digest for values of this type")
    yield b"</>"


@contextmanager
def _locked(path: Path) -> Iterator[None]:
    with path.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def evidence(why: tl.Diagnosis, effect: str) -> float:
    """Probability of an effect before calibration, which tempers the clearest evidence."""
    return float(why.details["evidence"]["effects"][effect])
