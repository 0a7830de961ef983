"""Wording that every message about an unknown name shares."""

import difflib
from collections.abc import Iterable


def nearest(name: str, known: Iterable[str], *, likeness: float = 0.6) -> str | None:
    """The known name most like `name`, or None where none reaches `likeness`, from 0 to 1 (the same)."""
    matches = difflib.get_close_matches(str(name), list(known), n=1, cutoff=likeness)
    return matches[0] if matches else None


def expected_one_of(name: str, known: Iterable[str]) -> str:
    """What was expected instead of `name`: the nearest known name, otherwise all of them."""
    names = list(known)
    match = nearest(name, names)
    if match is not None:
        return f"did you mean {match!r}?"
    return f"expected one of {', '.join(names)}" if names else "none is available"
