"""What is kept of a run: its samples, or a summary of them."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from tendonlab.arguments import choice
from tendonlab.errors import ParameterError

Reduce = Callable[[np.ndarray], np.ndarray]  # (points, outputs, samples) -> (points, ...)


def _rms(chunk: np.ndarray) -> np.ndarray:
    return np.asarray(np.sqrt(np.mean(np.square(chunk), axis=-1)))


# Summaries over time by name: (points, outputs, samples) -> (points, outputs), in the unit of each output.
SUMMARIES: dict[str, Reduce] = {
    "rms": _rms,
    "mean": lambda chunk: np.asarray(chunk.mean(axis=-1)),
    "min": lambda chunk: np.asarray(chunk.min(axis=-1)),
    "max": lambda chunk: np.asarray(chunk.max(axis=-1)),
    "peak": lambda chunk: np.asarray(np.abs(chunk).max(axis=-1)),
    "final": lambda chunk: chunk[..., -1],
}


@dataclass(frozen=True)
class Reduction:
    """A summary of the library by its `name`, or a `function` of the caller, which is named after it."""

    name: str
    function: Reduce | None = None

    def require_portable(self) -> None:
        """Raise ParameterError for a function that cannot be sent to another process."""
        try:
            pickle.dumps(self.function)
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            expected = "a function defined at the top of a module, which other processes can import"
            raise ParameterError(f"reduce = {self.name}: {error}; expected {expected}") from error

    def require_free_name(self, taken: Iterable[str]) -> None:
        """Raise ParameterError for a function that is named as a coordinate of the result."""
        if self.function is not None and self.name in taken:
            raise ParameterError(
                f"reduce = {self.name}: the result has a coordinate of that name; expected another name"
            )

    @property
    def by_output(self) -> bool:
        """Whether each output has a summary of its own."""
        return self.function is None

    def __call__(self, chunk: np.ndarray, failed: Sequence[bool]) -> np.ndarray:
        """The summary of each point, shape (points, ...); NaN where the run failed."""
        if self.function is None:
            return SUMMARIES[self.name](chunk)
        given = np.asarray(self.function(chunk))
        if given.shape[:1] != chunk.shape[:1] or given.dtype.kind not in "biuf":
            gave = f"gave shape {given.shape} of {given.dtype} for {len(chunk)} points"
            raise ParameterError(f"reduce = {self.name}: {gave}; expected numbers, shape ({len(chunk)}, ...)")
        kept = np.array(given, dtype=float)
        kept[np.asarray(failed, dtype=bool)] = np.nan
        return kept


def reduction_of(given: str | Reduce | None) -> Reduction | None:
    """The reduction that `sweep` is asked for; None where all samples are kept."""
    if given is None:
        return None
    if isinstance(given, str):
        return Reduction(choice("reduce", given, tuple(SUMMARIES)))
    if not callable(given):
        expected = f"one of {', '.join(SUMMARIES)}, or a function of (points, outputs, samples)"
        raise ParameterError(f"reduce = {given!r:.60}: expected {expected}")
    name = getattr(given, "__name__", type(given).__name__)
    return Reduction("reduced" if name == "<lambda>" else name, given)
