"""The demo, run once for all tests as a user runs it, and the diagnosis that it wrote."""

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import tendonlab as tl
from budget import shared
from diagnoses import HOOK, diagnose
from tendonlab.cli.demo import bundled
from tendonlab.report.diagnosis import Diagnosis

DEMO = "from tendonlab.cli.commands import main; sys.exit(main(['demo']))"


@dataclass(frozen=True)
class TwinDiagnosis:
    """What `tendonlab demo`, run in `folder`, printed, and the diagnosis in its `tendonlab-demo`."""

    folder: Path
    printed: subprocess.CompletedProcess[str]
    diagnosis: Diagnosis


def run_demo(folder: Path) -> TwinDiagnosis:
    """`tendonlab demo` in an empty folder, in a process of its own."""
    command = [sys.executable, "-c", HOOK + DEMO]
    with shared():
        printed = subprocess.run(command, cwd=folder, capture_output=True, encoding="utf-8", timeout=1800, check=False)
    assert printed.returncode == 0, printed.stderr
    return TwinDiagnosis(folder, printed, diagnose(tl.load(bundled())))
