"""Friction and transmission models of cable- and tendon-driven mechanisms, and why simulators miss reality."""

from importlib.metadata import version as _version

from tendonlab._core import actuation, friction, loading, sensing, sheath, transmission
from tendonlab.catalog import kinds, system_info
from tendonlab.data import Dataset, Experiment, load
from tendonlab.diagnose import Diagnosis, diagnose
from tendonlab.errors import DatasetError, NumericalError, ParameterError
from tendonlab.identify import Identification, identify
from tendonlab.routing import BranchLosses, Reducer, TendonTransmission
from tendonlab.sweep import sweep
from tendonlab.system import System
from tendonlab.trajectory import Trajectory

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
