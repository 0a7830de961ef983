"""Friction and transmission models of cable- and tendon-driven mechanisms, and why simulators miss reality."""

from importlib.metadata import version as _version

from tendonlab._core import actuation, friction, loading, sensing, sheath, transmission
from tendonlab.data import Dataset, Experiment, load
from tendonlab.diagnosis.diagnose import diagnose
from tendonlab.errors import DatasetError, NumericalError, ParameterError
from tendonlab.identification.identify import Identification, identify
from tendonlab.mechanics.tendons import BranchLosses, Reducer, TendonTransmission
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.simulation.catalog import kinds, system_info
from tendonlab.simulation.sweep import sweep
from tendonlab.simulation.system import System
from tendonlab.simulation.trajectory import Trajectory

__version__ = _version("tendonlab")
__all__ = [
    "BranchLosses",
    "Dataset",
    "DatasetError",
    "Diagnosis",
    "Experiment",
    "Identification",
    "NumericalError",
    "ParameterError",
    "Reducer",
    "System",
    "TendonTransmission",
    "Trajectory",
    "actuation",
    "diagnose",
    "friction",
    "identify",
    "kinds",
    "load",
    "loading",
    "sensing",
    "sheath",
    "sweep",
    "system_info",
    "transmission",
]
