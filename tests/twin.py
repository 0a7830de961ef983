"""The demo, run once for all tests, and its diagnosis for whatever else needs one."""

import pickle
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from tendonlab.report.diagnosis import Diagnosis

_DEMO = """
import pickle, sys
from pathlib import Path
from tendonlab.cli import commands as cli, demo

def kept(*given, **options):
    found = run(*given, **options)
    Path("diagnosis.pickle").write_bytes(pickle.dumps(found))
    return found

run, demo.demo = demo.demo, kept
sys.exit(cli.main(["demo"]))
"""
_REUSE = """
import pickle
from pathlib import Path
import tendonlab

def _known(rig, **options):
    return _found if rig.name == _found.dataset else _diagnose(rig, **options)

_found, _diagnose = pickle.loads(Path({path!r}).read_bytes()), tendonlab.diagnose
tendonlab.diagnose = _known
"""


@dataclass(frozen=True)
class TwinDiagnosis:
    """What `tendonlab demo`, run in `folder`, printed, wrote into its `tendonlab-demo` and found."""

    folder: Path
    printed: subprocess.CompletedProcess[str]
    diagnosis: Diagnosis

    @property
    def reuse(self) -> str:
        """Code after which `tl.diagnose` of the bundled rig gives this diagnosis, in whatever process it runs; that of
        other rigs stays as it is."""
        return _REUSE.format(path=str(self.folder / "diagnosis.pickle"))


def run_demo(folder: Path) -> TwinDiagnosis:
    """`tendonlab demo` in an empty folder, in a process of its own."""
    command = [sys.executable, "-c", _DEMO]
    printed = subprocess.run(command, cwd=folder, capture_output=True, encoding="utf-8", timeout=600, check=False)
    assert printed.returncode == 0, printed.stderr
    return TwinDiagnosis(folder, printed, pickle.loads((folder / "diagnosis.pickle").read_bytes()))
