"""Figures of a diagnosis: functions that draw on the axes they are given, and never show them."""

from tendonlab.report.plot.effects import ranked_effects
from tendonlab.report.plot.gap import gap_bars
from tendonlab.report.plot.runs import overlay
from tendonlab.report.plot.where import where_map

__all__ = ["gap_bars", "overlay", "ranked_effects", "where_map"]
