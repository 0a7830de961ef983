"""Diagnose every blind case in a process of its own, and seal the verdicts with a hash before anyone opens the
truth.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from tqdm import tqdm

from .reach import refuse_truth
from .write import write_at_once

REPORT = "report.json"
FAILURE = "failed.txt"  # why a case has no report
VERDICTS = "verdicts.json"


def command(case: Path, out: Path) -> list[str]:
    """The command that diagnoses one case; it is given the case's folder and nothing else."""
    return [sys.executable, "-m", "tendonlab", "diagnose", str(case), "--out", str(out), "--no-figures"]


def run(cases: Path | str, out: Path | str, *, jobs: int = 1, timeout: float = 1800.0, progress: bool = True) -> Path:
    """Diagnose all cases into `out`/<id>, skipping those that have a report or failed, and return `out`/verdicts.json.

    A case that fails is recorded there as "failed" with the last line it wrote; so is one that takes longer than
    `timeout`, s. It gets no second try unless its failed.txt is removed. Raises ValueError where `cases` holds
    no dataset, or where a truth lies below `cases`, next to `cases` or below `out`, see `refuse_truth`.
    """
    cases, out = Path(cases).resolve(), Path(out).resolve()
    folders = cases_in(cases)
    refuse_truth(cases.parent, out)
    commands = {folder.name: command(folder, out / folder.name) for folder in folders}
    failed = run_all(commands, out, jobs=jobs, timeout=timeout, progress=progress)
    return _seal(out, list(commands), failed)


def cases_in(cases: Path) -> list[Path]:
    """The folders of the cases; raises ValueError without any."""
    folders = sorted(path.parent for path in cases.glob("*/dataset.toml"))
    if not folders:
        raise ValueError(f"{cases}: expected folders with a dataset.toml, found none")
    return folders


def run_all(
    commands: Mapping[str, Sequence[str]], out: Path, *, jobs: int, timeout: float, progress: bool
) -> dict[str, str]:
    """Run the command of each case that has no report yet in `out` and did not fail; of those that failed, why."""
    out.mkdir(parents=True, exist_ok=True)
    failures = {name: out / name / FAILURE for name in commands}
    failed = {name: path.read_text(encoding="utf-8").strip() for name, path in failures.items() if path.exists()}
    todo = [name for name in commands if name not in failed and not (out / name / REPORT).exists()]
    with ThreadPoolExecutor(max(1, jobs)) as pool:
        pending = {pool.submit(_diagnose, commands[name], out / name, timeout): name for name in todo}
        done = tqdm(as_completed(pending), total=len(todo), desc="diagnose", unit="case", disable=not progress)
        for future in done:
            name, message = pending[future], future.result()
            if message:  # not written by the thread: an interrupt ends the diagnosis, too, which is no failure
                failed[name] = message
                write_at_once(failures[name], f"{message}\n")
    return failed


def sha256(path: Path) -> str:
    """Hex digest of a file's bytes."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _diagnose(command: Sequence[str], out: Path, timeout: float) -> str:
    """Empty if it went well, else the last line that the process wrote, or that the time was up."""
    out.mkdir(parents=True, exist_ok=True)
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=timeout)
    except subprocess.TimeoutExpired:
        (out / REPORT).unlink(missing_ok=True)
        return f"no verdict within {timeout:g} s"
    (out / "log.txt").write_text(done.stdout + done.stderr, encoding="utf-8")
    if done.returncode == 0 and (out / REPORT).exists():
        return ""
    lines = (done.stderr or done.stdout).strip().splitlines() or [f"no {REPORT} was written"]
    return f"exit {done.returncode}: {lines[-1]}"


def _seal(out: Path, names: list[str], failed: dict[str, str]) -> Path:
    reports: dict[str, dict[str, object]] = {}
    for name in names:
        path = out / name / REPORT
        if not path.exists():
            reports[name] = {"verdict": "failed", "message": failed.get(name, "no report")}
            continue
        report = json.loads(path.read_text(encoding="utf-8"))
        reports[name] = {"verdict": report["verdict"], "selected": report.get("selected", []), "sha256": sha256(path)}
    target = out / VERDICTS
    target.write_text(
        json.dumps({"format": "tendonlab-verdicts/1", "reports": reports}, indent=1) + "\n", encoding="utf-8"
    )
    return target
