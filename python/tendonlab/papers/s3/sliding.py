"""Slope and offset of the sliding phase of a record, without a model of the dead zone (S3 Fig. 5)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tendonlab.errors import DatasetError
from tendonlab.papers.s3.groups import Record

FEWEST = 20  # samples in each direction


@dataclass(frozen=True)
class Sliding:
    """tau_out = `slope` tau_in + `offset` sign(v): `offset`, N·m, is negative, half the height of the loop.

    `dead_share`: share of the time in which the drive was slower than the threshold."""

    slope: float
    offset: float
    dead_share: float


def sliding_regression(record: Record, *, v_thres: float, margin: float = 3.0) -> Sliding:
    """Least squares over the samples faster than `margin` times `v_thres`, deg/s.

    Raises DatasetError where too few samples slide in either direction."""
    v = record.log["v"].to_numpy()
    fast = np.abs(v) > margin * v_thres
    if min(np.sum(fast & (v > 0)), np.sum(fast & (v < 0))) < FEWEST:
        limit = margin * v_thres
        raise DatasetError(f"{record.name}: fewer than {FEWEST} samples in a direction are faster than {limit:g} deg/s")
    terms = np.column_stack([record.log["tau_in"].to_numpy(), np.sign(v)])[fast]
    slope, offset = np.linalg.lstsq(terms, record.log["tau_out"].to_numpy()[fast], rcond=None)[0]
    return Sliding(float(slope), float(offset), float(np.mean(np.abs(v) <= v_thres)))
