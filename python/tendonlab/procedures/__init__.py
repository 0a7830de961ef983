"""Treatments of logs before a fit, as the papers do them, for your own logs.

Arrays in, arrays or frames out; SI units, time in s. Bad input raises ParameterError."""

from tendonlab.procedures.correlation import correlation_shift
from tendonlab.procedures.denoise import universal_threshold, wavelet_denoise
from tendonlab.procedures.differentiate import velocity
from tendonlab.procedures.filtering import lowpass, remove_mean
from tendonlab.procedures.load_cells import LoadCell, pretension_from_load_cells, reactive_torque
from tendonlab.procedures.maps import MapPoint, friction_map, map_point
from tendonlab.procedures.markers import MarkerSpline, WrapAngle, sort_markers, wrap_angle_uncertainty
from tendonlab.procedures.partition import split
from tendonlab.procedures.plateaus import steady_averages
from tendonlab.procedures.reversal import reversal_mask, reversals
from tendonlab.procedures.search import SearchResult, global_search
from tendonlab.procedures.sheath_shape import Shape
from tendonlab.procedures.steady import steady_segment
from tendonlab.procedures.synchronisation import jumps, time_shift

__all__ = [
    "LoadCell",
    "MapPoint",
    "MarkerSpline",
    "SearchResult",
    "Shape",
    "WrapAngle",
    "correlation_shift",
    "friction_map",
    "global_search",
    "jumps",
    "lowpass",
    "map_point",
    "pretension_from_load_cells",
    "reactive_torque",
    "remove_mean",
    "reversal_mask",
    "reversals",
    "sort_markers",
    "split",
    "steady_averages",
    "steady_segment",
    "time_shift",
    "universal_threshold",
    "velocity",
    "wavelet_denoise",
    "wrap_angle_uncertainty",
]
