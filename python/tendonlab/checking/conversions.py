"""Ratios of units that people confuse."""

from __future__ import annotations

import math
from typing import NamedTuple

# Ratio, how it and its inverse are written, and what confuses by it.
KNOWN = (
    (1e6, "a million", "1/1000000", "a prefix such as micro"),
    (1000.0, "1000", "1/1000", "a prefix such as milli"),
    (100.0, "100", "1/100", "a prefix such as centi"),
    (360.0, "360", "1/360", "turns and degrees"),
    (180.0 / math.pi, "180/pi", "pi/180", "degrees and radians"),
    (60.0, "60", "1/60", "minutes and seconds"),
    (9.81, "9.81", "1/9.81", "kilogram-force and newton"),
    (4.448, "4.448", "1/4.448", "pound-force and newton"),
    (2.0 * math.pi, "2 pi", "1/(2 pi)", "turns and radians"),
    (2.0, "2", "1/2", "a diameter and a radius, or both sides and one"),
    (math.sqrt(3.0), "sqrt(3)", "1/sqrt(3)", "values of a phase and of a line, as of a motor's current"),
)


class Confusion(NamedTuple):
    """A ratio, how it is written, and what confuses by it."""

    ratio: float
    label: str
    words: str


def nearest(value: float) -> Confusion:
    """The confusion whose ratio is nearest to a positive factor."""
    known = [Confusion(ratio, label, words) for ratio, label, _, words in KNOWN]
    known += [Confusion(1.0 / ratio, inverse, words) for ratio, _, inverse, words in KNOWN]
    return min(known, key=lambda confusion: abs(math.log(value / confusion.ratio)))
