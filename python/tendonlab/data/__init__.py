"""Reading, checking and fetching datasets: experiments as frames in SI units (FORMATS section 1)."""

from tendonlab.data.dataset import Controller, Dataset, Experiment, NominalParameter, SignalSpec, require_dataset
from tendonlab.data.folder import load

__all__ = ["Controller", "Dataset", "Experiment", "NominalParameter", "SignalSpec", "load", "require_dataset"]
