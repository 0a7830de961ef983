"""The three errors of the library: each message carries the name, the offending value and what was expected."""

import difflib
import re
from collections.abc import Iterable


class ParameterError(ValueError):
    """A name or a value given by the caller is unknown or out of its bounds."""


class DatasetError(ValueError):
    """A dataset breaks the format: names file, key or column, row where there is one, and what was expected."""


class NumericalError(ArithmeticError):
    """A computation left the finite numbers: names the quantity, when, and the likely cause."""


def nearest_name(name: str, known: Iterable[str], *, likeness: float = 0.6) -> str | None:
    """The known name most like `name`, or None where none reaches `likeness`, from 0 to 1 (the same)."""
    # As text, "run-1" is as near to "run-10" as to "run-01".
    plain = {_without_leading_zeros(each): each for each in known}
    matches = difflib.get_close_matches(_without_leading_zeros(str(name)), plain, n=1, cutoff=likeness)
    return plain[matches[0]] if matches else None


def _without_leading_zeros(name: str) -> str:
    return re.sub(r"(?<!\d)0+(?=\d)", "", name)


def expected_one_of(name: str, known: Iterable[str]) -> str:
    """What was expected instead of `name`, for a message: the nearest known name, otherwise all of them."""
    names = list(known)
    match = nearest_name(name, names)
    if match is not None:
        return f"did you mean {match!r}?"
    return f"expected one of {', '.join(names)}" if names else "none is available"
