"""How laws combine in one slot or chain, where no system of the library has the combination: small programs ask."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

HERE = Path(__file__).parent
COMPILER = os.environ.get("CXX") or shutil.which("c++")

pytestmark = pytest.mark.skipif(COMPILER is None, reason="needs a C++ compiler")


def compiled(source: str, program: Path, *flags: str) -> subprocess.CompletedProcess[str]:
    headers = HERE.parents[1] / "cpp"
    build = [str(COMPILER), "-std=c++17", *flags, "-I", str(headers), str(HERE / source), "-o", str(program)]
    return subprocess.run(build, check=False, capture_output=True, encoding="utf-8")


@pytest.mark.parametrize("name", ["slot_gap", "chain_state"])
def test_the_program_finds_what_it_expects(name: str, tmp_path: Path) -> None:
    build = compiled(f"{name}.cpp", tmp_path / name)
    assert build.returncode == 0, build.stderr
    assert subprocess.run([tmp_path / name], check=False).returncode == 0


def test_a_state_from_sample_to_sample_is_refused_where_there_are_no_samples(tmp_path: Path) -> None:
    build = compiled("chain_state.cpp", tmp_path / "chain_state", "-DCONTINUOUS")
    assert build.returncode != 0
    assert "keeps a state from sample to sample: only a sampled system can hold it" in build.stderr
