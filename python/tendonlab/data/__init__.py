"""Reading, checking and fetching datasets: experiments as frames in SI units."""

from tendonlab.data.dataset import Dataset, require_dataset, simulator_of
from tendonlab.data.folder import load
from tendonlab.simulation.records import Controller, Experiment, NominalParameter, SignalSpec

__all__ = [
    "Controller",
    "Dataset",
    "Experiment",
    "NominalParameter",
    "SignalSpec",
    "load",
    "require_dataset",
    "simulator_of",
]
