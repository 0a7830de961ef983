"""tendonlab: friction and transmission models of cable- and tendon-driven mechanisms, and why simulators miss reality."""

from importlib import import_module
from importlib.metadata import version as _version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tendonlab._core import actuation as actuation
    from tendonlab._core import friction as friction
    from tendonlab._core import sensing as sensing
    from tendonlab._core import transmission as transmission
    from tendonlab.catalog import kinds as kinds
    from tendonlab.catalog import system_info as system_info
    from tendonlab.data import Dataset as Dataset
    from tendonlab.data import Experiment as Experiment
    from tendonlab.data import load as load
    from tendonlab.diagnose import Diagnosis as Diagnosis
    from tendonlab.diagnose import diagnose as diagnose
    from tendonlab.errors import DatasetError as DatasetError
    from tendonlab.errors import NumericalError as NumericalError
    from tendonlab.errors import ParameterError as ParameterError
    from tendonlab.identify import Identification as Identification
    from tendonlab.identify import identify as identify
    from tendonlab.sweep import sweep as sweep
    from tendonlab.system import System as System
    from tendonlab.trajectory import Trajectory as Trajectory

__version__ = _version("tendonlab")
_HOME = {
    "actuation": "_core", "friction": "_core", "sensing": "_core", "transmission": "_core",
    "kinds": "catalog", "system_info": "catalog",
    "Dataset": "data", "Experiment": "data", "load": "data",
    "Diagnosis": "diagnose", "diagnose": "diagnose",
    "DatasetError": "errors", "NumericalError": "errors", "ParameterError": "errors",
    "Identification": "identify", "identify": "identify",
    "sweep": "sweep", "System": "system", "Trajectory": "trajectory",
}  # fmt: skip
__all__ = [*_HOME, "__version__"]  # noqa: PLE0604


def __getattr__(name: str) -> Any:
    """Public names load on first use: `import tendonlab` stays quick."""
    if name not in _HOME:
        raise AttributeError(f"module 'tendonlab' has no attribute {name!r}")
    value = getattr(import_module(f"tendonlab.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
