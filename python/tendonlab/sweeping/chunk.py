"""What one task does: simulate some points of one experiment, and keep what is asked for."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from tendonlab.sweeping.reductions import Reduction
from tendonlab.sweeping.run import Run
from tendonlab.threads import with_one_blas_thread

BLOCK_BYTES = 4e6  # of outputs that are reduced at a time: they stay in the cache


@dataclass(frozen=True)
class Chunk:
    """Results at consecutive points: `kept`, shape (points, ...), a message for each, and the `seconds` it took."""

    kept: np.ndarray
    messages: list[str]
    seconds: float


@dataclass(frozen=True)
class Keep:
    """What is kept of each point: all samples, or a `reduction` of them, as numbers of `dtype`. `length`: samples of
    the longest experiment; shorter ones end in NaN."""

    reduction: Reduction | None
    dtype: str
    length: int


def simulate_chunk(run: Run, points: np.ndarray, keep: Keep, into: np.ndarray | None = None) -> Chunk:
    """Simulate points (n, names), in this thread alone. `into`: memory of the caller that the samples are written to;
    it needs the shape (n, channels, samples)."""
    began = time.perf_counter()
    if keep.reduction is None:
        kept, messages = _samples(run, points, keep, into)
    else:
        # A function of the caller may multiply matrices: in one thread, so that threads change no bit.
        reduced = with_one_blas_thread(_reduced) if keep.reduction.function else _reduced
        kept, messages = reduced(run, points, keep.reduction)
        kept = kept.astype(keep.dtype)
    return Chunk(kept, messages, time.perf_counter() - began)


def simulate_first(run: Run, points: np.ndarray, keep: Keep, seconds: float) -> Chunk:
    """Simulate the first points until `seconds` have passed: what later chunks are sized by."""
    done: list[Chunk] = []
    spent, first, size = 0.0, 0, 1
    while first < len(points) and (not done or spent < seconds):
        done.append(simulate_chunk(run, points[first : first + size], keep))
        spent += done[-1].seconds
        first, size = first + size, 2 * size
    kept = np.concatenate([chunk.kept for chunk in done])
    return Chunk(kept, [message for chunk in done for message in chunk.messages], spent)


def _samples(run: Run, points: np.ndarray, keep: Keep, into: np.ndarray | None) -> tuple[np.ndarray, list[str]]:
    own = run.num_samples
    if into is not None and own == keep.length:
        return into, run.simulate(points, into)
    out = np.empty((len(points), len(run.channels), own), dtype=keep.dtype)
    messages = run.simulate(points, out)
    if own == keep.length:
        return out, messages
    padded = np.full((*out.shape[:2], keep.length), np.nan, dtype=keep.dtype)
    padded[..., :own] = out
    return padded, messages


def _reduced(run: Run, points: np.ndarray, reduction: Reduction) -> tuple[np.ndarray, list[str]]:
    samples = len(run.channels) * run.num_samples
    size = max(1, int(BLOCK_BYTES / (8 * samples)))
    parts, messages = [], []
    for first in range(0, len(points), size):
        block = points[first : first + size]
        out = np.empty((len(block), len(run.channels), run.num_samples))
        told = run.simulate(block, out)
        parts.append(reduction(out, [bool(text) for text in told]))
        messages += told
    return np.concatenate(parts), messages
