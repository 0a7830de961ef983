"""Figures of a diagnosis: functions that draw on the axes they are given, and never show them."""

from tendonlab.plot.effects import ranked_effects
from tendonlab.plot.gap import gap_bars
from tendonlab.plot.runs import overlay
from tendonlab.plot.where import where_map

__all__ = ["gap_bars", "overlay", "ranked_effects", "where_map"]
