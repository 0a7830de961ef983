"""Write a diagnosis to a folder."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from tendonlab.errors import ParameterError

if TYPE_CHECKING:
    from tendonlab.report.diagnosis import Diagnosis


def prepare_folder(out: str | Path) -> Path:
    """Make the folder `out` where it does not exist, and try to write into it: before hours are spent on what is to be
    written there. Raises ParameterError where `out` is a file, OSError where it cannot be made or written to."""
    out = Path(out)
    if out.exists() and not out.is_dir():
        raise ParameterError(f"out = {str(out)!r} is a file: expected a folder")
    out.mkdir(parents=True, exist_ok=True)
    with _unfinished(out):
        return out


def write_report(diagnosis: Diagnosis, out: Path, *, figures: bool = True) -> Path:
    """Write report.html, report.json, the references of proposed motions, and each figure as PNG and SVG if `figures`;
    the path of report.html.

    Each file appears in `out` when all of them are complete: an interrupted call leaves what was there before."""
    from tendonlab.report.document import page
    from tendonlab.report.figures import draw_all

    out = prepare_folder(out)
    pictures = draw_all(diagnosis)
    with _unfinished(out) as folder:
        for name, picture in pictures.items() if figures else ():
            (folder / f"{name}.svg").write_text(picture.svg, encoding="utf-8")
            (folder / f"{name}.png").write_bytes(picture.png)
        for name, reference in diagnosis.references.items():
            reference.to_csv(folder / name, index=False, float_format="%.9g")
        text = json.dumps(diagnosis.to_dict(), indent=2, ensure_ascii=False, allow_nan=False)
        (folder / "report.json").write_text(text + "\n", encoding="utf-8")
        (folder / "report.html").write_text(page(diagnosis, pictures), encoding="utf-8")
        for finished in sorted(folder.iterdir()):
            finished.replace(out / finished.name)
    return out / "report.html"


@contextmanager
def _unfinished(out: Path) -> Iterator[Path]:
    """A hidden folder within `out`, for files that are being written."""
    with TemporaryDirectory(dir=out, prefix=".unfinished-") as folder:
        yield Path(folder)
