"""Draw docs/figures/report.png: the top of the HTML report of `tendonlab demo`, as a browser shows it.

    tendonlab demo --out tendonlab-demo
    python docs/figures/report.py tendonlab-demo/report.html

Needs chromium (`apt-get install chromium`) and Pillow, which matplotlib brings along."""

import subprocess
import sys
from pathlib import Path

from PIL import Image

WIDTH, HEIGHT, COLOURS = 1100, 1425, 256


def main(report: Path) -> None:
    """Photograph `report`, crop it and keep a palette of few colours: the file stays small."""
    out = Path(__file__).with_name("report.png")
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--window-size={WIDTH},{HEIGHT}"]
    subprocess.run(["chromium", *options, f"--screenshot={out}", report.resolve().as_uri()], check=True)
    Image.open(out).convert("RGB").quantize(COLOURS).save(out, optimize=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
