"""What elements, graphs, equations and drawings refuse: the message names it, its value and what was expected."""

from collections.abc import Callable

import matplotlib.pyplot as plt
import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.mechanics.bondgraph import GY, TF, BondGraph, C, Equations, I, One, R, Se, Sf, derive, draw

ELEMENTS = [Se(name="V"), One(name="j"), I(name="m", inertia=2.0)]
CHAINS = [("V", "j", "m")]


def rates(state: dict[str, float], inputs: dict[str, float]) -> dict[str, float]:
    equations: Equations = derive(BondGraph.of(ELEMENTS, CHAINS, {"x": "j"}))
    return equations.rates(state, inputs)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: BondGraph.of(ELEMENTS, CHAINS, {"m": "j"}), "position 'm': an element has that name"),
        (lambda: TF(name="gear", ratio=0.0), r"TF gear: ratio = 0\.0: expected a number other than 0"),
        (lambda: TF(name="gear", ratio=np.nan), r"TF gear: ratio = nan: expected"),
        (lambda: GY(name="k", ratio=0.0), r"GY k: ratio = 0\.0: expected a number other than 0"),
        (lambda: GY(name="k", ratio=np.inf), r"GY k: ratio = inf: expected"),
        (lambda: R(name="d", effort=np.nan), r"R d: effort = nan: expected"),
        (lambda: C(name="k", effort=np.inf), r"C k: effort = inf: expected"),
        (lambda: I(name="m", inertia=np.nan), r"m = nan: expected a positive inertia"),
        (lambda: Se(name="F", value=np.nan), r"Se F: value = nan: expected"),
        (lambda: Sf(name="f", value=-np.inf), r"Sf f: value = -inf: expected"),
        (lambda: rates({"m": np.nan, "x": 0.0}, {"V": 1.0}), r"state 'm' = nan: expected"),
        (lambda: rates({"m": 1.0, "x": 0.0}, {"V": np.inf}), r"input 'V' = inf: expected"),
        (lambda: rates({"m": 1.0, "x": 0.0, "n": 0.0}, {"V": 1.0}), "state = 'n': "),
        (lambda: rates({"m": 1.0, "x": 0.0}, {"V": 1.0, "W": 1.0}), "input = 'W': "),
        (lambda: draw(BondGraph.of([], [])), r"graph.elements = \(\): expected one element or more"),
        (
            lambda: draw(BondGraph.of(ELEMENTS, CHAINS), at={"V": (0, 0), "j": (np.nan, 0), "m": (2, 0)}),
            r"at\['j'\]\[0\] = nan: expected a finite number",
        ),
    ],
)
def test_what_makes_no_sense_is_refused(call: Callable[[], object], told: str) -> None:
    with pytest.raises(ParameterError, match=told):
        call()
    plt.close("all")
