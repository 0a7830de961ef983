"""What docs/papers.md says of the notebooks: which cell shows which figure or table."""

import re
from dataclasses import dataclass
from pathlib import Path

PAGE = Path(__file__).resolve().parents[2] / "docs" / "papers.md"
ROW = re.compile(r"^\| (S\d) \| ([^|]*) \| ([^|]*) \| ([^|]*) \| [^|]+ \|$", re.M)


@dataclass(frozen=True)
class Shown:
    """A row of the page: `paper`, `what` is shown, as written, in the `section` and the `cell`, or "" where not."""

    paper: str
    what: str
    section: str
    cell: str

    @property
    def labels(self) -> tuple[str, ...]:
        """Figures and tables one by one, "Fig. 8a" and the like; none where the row names something else."""
        found = re.fullmatch(r"(Fig\.|Table) (.+)", self.what)
        if found is None:
            return ()
        names: list[str] = []
        for name in found[2].split(", "):
            first, _, last = name.partition("–")
            names += [str(k) for k in range(int(first), int(last) + 1)] if last else [first]
        return tuple(f"{found[1]} {name}" for name in names)


def rows() -> list[Shown]:
    """All rows of the page's table of figures and tables."""
    text = PAGE.read_text(encoding="utf-8").partition("## What is reproduced, and where")[2]
    found = []
    for paper, what, section, cell in ROW.findall(text):
        quoted = re.fullmatch(r'"([^"]+)"', section)
        named = re.fullmatch(r"`([\w-]+)`", cell)
        assert bool(quoted) == bool(named), (paper, what)
        found.append(Shown(paper, what, quoted[1] if quoted else "", named[1] if named else ""))
    return found


def shows(label: str, text: str) -> bool:
    """Whether the outputs of a cell name a figure or table; a following number in parentheses is a part of it."""
    return re.search(rf"(?<![\w]){re.escape(label)}(?![0-9a-zA-Z])", text) is not None
