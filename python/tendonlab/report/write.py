"""Write a diagnosis to a folder."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tendonlab.report.diagnosis import Diagnosis


def write_report(diagnosis: Diagnosis, out: Path, *, figures: bool = True) -> Path:
    """Write report.html and report.json, and each figure as PNG and SVG if `figures`; the path of report.html."""
    from tendonlab.report.figures import draw_all
    from tendonlab.report.page import page

    out.mkdir(parents=True, exist_ok=True)
    pictures = draw_all(diagnosis)
    if figures:
        for name, picture in pictures.items():
            (out / f"{name}.svg").write_text(picture.svg, encoding="utf-8")
            (out / f"{name}.png").write_bytes(picture.png)
    text = json.dumps(diagnosis.to_dict(), indent=2, ensure_ascii=False, allow_nan=False)
    (out / "report.json").write_text(text + "\n", encoding="utf-8")
    target = out / "report.html"
    target.write_text(page(diagnosis, pictures), encoding="utf-8")
    return target
