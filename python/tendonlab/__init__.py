"""Friction and transmission models of cable- and tendon-driven mechanisms, and why simulators miss reality."""

from importlib import import_module as _import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tendonlab._core import actuation, ends, friction, loading, sensing, sheath, transmission
    from tendonlab.checking.check import check
    from tendonlab.checking.finding import Check
    from tendonlab.data.dataset import Dataset
    from tendonlab.data.folder import load
    from tendonlab.diagnosis.diagnose import diagnose
    from tendonlab.errors import DatasetError, NumericalError, ParameterError
    from tendonlab.identification.identify import identify
    from tendonlab.identification.result import Identification
    from tendonlab.mechanics.tendons import BranchLosses, Reducer, TendonTransmission
    from tendonlab.rehearsal.rehearse import rehearse
    from tendonlab.rehearsal.result import Rehearsal
    from tendonlab.report.diagnosis import Diagnosis
    from tendonlab.simulation.catalog import kinds, system_info
    from tendonlab.simulation.records import Experiment
    from tendonlab.simulation.system import System
    from tendonlab.simulation.trajectory import Trajectory
    from tendonlab.sweeping.sweep import sweep

    __version__: str

__all__ = [
    "BranchLosses",
    "Check",
    "Dataset",
    "DatasetError",
    "Diagnosis",
    "Experiment",
    "Identification",
    "NumericalError",
    "ParameterError",
    "Reducer",
    "Rehearsal",
    "System",
    "TendonTransmission",
    "Trajectory",
    "actuation",
    "check",
    "diagnose",
    "ends",
    "friction",
    "identify",
    "kinds",
    "load",
    "loading",
    "rehearse",
    "sensing",
    "sheath",
    "sweep",
    "system_info",
    "transmission",
]

# Where each public name is defined: a module is loaded when its first name is used, so that the import takes no time.
_HOMES = {
    "tendonlab._core": "actuation ends friction loading sensing sheath transmission",
    "tendonlab.checking.check": "check",
    "tendonlab.checking.finding": "Check",
    "tendonlab.data.dataset": "Dataset",
    "tendonlab.data.folder": "load",
    "tendonlab.diagnosis.diagnose": "diagnose",
    "tendonlab.errors": "DatasetError NumericalError ParameterError",
    "tendonlab.identification.identify": "identify",
    "tendonlab.identification.result": "Identification",
    "tendonlab.mechanics.tendons": "BranchLosses Reducer TendonTransmission",
    "tendonlab.rehearsal.rehearse": "rehearse",
    "tendonlab.rehearsal.result": "Rehearsal",
    "tendonlab.report.diagnosis": "Diagnosis",
    "tendonlab.simulation.catalog": "kinds system_info",
    "tendonlab.simulation.records": "Experiment",
    "tendonlab.simulation.system": "System",
    "tendonlab.simulation.trajectory": "Trajectory",
    "tendonlab.sweeping.sweep": "sweep",
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names.split()}
_PACKAGES = (
    "blind",
    "checking",
    "cli",
    "data",
    "diagnosis",
    "identification",
    "mechanics",
    "papers",
    "procedures",
    "rehearsal",
    "report",
    "simulation",
    "sweeping",
)

if not TYPE_CHECKING:  # otherwise every misspelt name would pass the type checker

    def __getattr__(name: str) -> object:
        if name == "__version__":
            value = _import_module("tendonlab.version").version()
        elif name in _HOME_OF:
            value = getattr(_import_module(_HOME_OF[name]), name)
        elif name in _PACKAGES:
            value = _import_module(f"tendonlab.{name}")
        else:
            raise AttributeError(f"module 'tendonlab' has no attribute {name!r}")
        globals()[name] = value
        return value

    def __dir__() -> list[str]:
        return sorted({*globals(), *__all__, *_PACKAGES, "__version__"})
