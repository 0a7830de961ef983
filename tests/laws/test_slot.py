"""How laws combine in one slot, where no system of the library has the combination: a small program asks the slot."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).parent
COMPILER = os.environ.get("CXX") or shutil.which("c++")


@pytest.mark.skipif(COMPILER is None, reason="needs a C++ compiler")
def test_a_second_law_of_motion_leaves_the_gap_open(tmp_path: Path) -> None:
    program = tmp_path / "slot_gap"
    headers = HERE.parents[1] / "cpp"
    build = [str(COMPILER), "-std=c++17", "-I", str(headers), str(HERE / "slot_gap.cpp"), "-o", str(program)]
    subprocess.run(build, check=True)
    assert subprocess.run([program], check=False).returncode == 0
