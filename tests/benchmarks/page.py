"""Writes tables into docs/performance.md, and says where and of what they were measured."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

from benchmarks.plot import OUT

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "performance.md"
FIGURE = ROOT / "docs" / "figures" / "work-precision.svg"


def write(job: str, text: str, *, rounds: int) -> None:
    """Put the tables of a job in their place, and the figure if the job drew it."""
    said = f"Measured at commit {commit()} on {machine()}; least of at most {rounds} rounds.\n"
    PAGE.write_text(placed(PAGE.read_text(encoding="utf-8"), job, f"{text}\n{said}"), encoding="utf-8")
    if job == "single" and OUT.exists():
        shutil.copy(OUT, FIGURE)


def placed(page: str, job: str, text: str) -> str:
    """`page` with `text` between the marks of `job`. Raises ValueError where it has no such marks."""
    begin, end = f"<!-- {job} -->\n", f"<!-- end of {job} -->"
    if begin not in page or end not in page:
        raise ValueError(f"{PAGE.name}: no marks of {job!r}; expected {begin.strip()!r} and {end!r}")
    before, rest = page.split(begin, 1)
    return f"{before}{begin}\n{text}\n{end}{rest.split(end, 1)[1]}"


def commit() -> str:
    """The short name of the commit; with a "+" where tracked files were changed since."""

    def git(*arguments: str) -> str:
        return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()

    changed = git("status", "--porcelain", "--untracked-files=no", "--", "cpp", "python")
    return git("rev-parse", "--short", "HEAD") + ("+" if changed else "")


def machine() -> str:
    """The kind of machine: word length of its vector instructions, and number of cores."""
    cpu = Path("/proc/cpuinfo")
    flags = cpu.read_text(encoding="utf-8") if cpu.exists() else ""
    kinds = (("AVX-512", r"\bavx512f\b"), ("AVX2", r"\bavx2\b"), ("no AVX2", ""))
    kind = next(name for name, flag in kinds if re.search(flag, flags))
    return f"a machine with {kind}, {os.cpu_count()} cores"
