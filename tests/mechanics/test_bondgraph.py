"""Graphs whose equations are known: oscillator, motor, coupled and moving inertias; what is refused."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.mechanics.bondgraph import (
    GY,
    MTF,
    TF,
    BondGraph,
    C,
    Element,
    I,
    One,
    R,
    Se,
    Sf,
    Zero,
    causality,
    derive,
    draw,
)

CART = [I(name="mass", inertia=2.0), C(name="spring", effort=50.0), R(name="damper", effort=0.7), One(name="v")]
CART_CHAINS = [("v", "mass"), ("v", "spring"), ("v", "damper")]


def pendulum(length: float = 0.4, mass: float = 3.0) -> BondGraph:
    """A hub of 0.1 kg*m^2 that carries a point mass: its velocity components follow the angle."""
    elements: list[Element] = [One(name="turn"), I(name="hub", inertia=0.1)]
    chains: list[tuple[str, ...]] = [("turn", "hub")]
    for axis, slope in {"x": lambda q: -length * np.sin(q), "y": lambda q: length * np.cos(q)}.items():
        elements += [MTF(name=axis, ratio=slope, of="angle"), One(name=f"v{axis}"), I(name=f"m{axis}", inertia=mass)]
        chains += [("turn", axis, f"v{axis}", f"m{axis}")]
    weight = Se(name="weight", value=-9.8 * mass)
    return BondGraph.of([*elements, weight], [*chains, ("weight", "vy")], {"angle": "turn"})


def test_an_oscillator() -> None:
    equations = derive(BondGraph.of(CART, CART_CHAINS))
    assert equations.states == ("mass", "spring")
    found = equations.rates({"mass": 3.0, "spring": 0.2})
    assert found["spring"] == 1.5  # p / m
    assert found["mass"] == pytest.approx(-50.0 * 0.2 - 0.7 * 1.5, rel=1e-15)


def test_a_motor_under_load() -> None:
    """Gyrator: torque k i on one side, voltage k omega on the other; the load pulls through a transformer."""
    graph = BondGraph.of(
        [Se(name="V"), One(name="i"), I(name="L", inertia=1e-3), R(name="R", effort=2.0), GY(name="k", ratio=0.3),
         One(name="w"), I(name="J", inertia=4e-4), TF(name="N", ratio=0.1), Se(name="F")],
        [("V", "i", "k", "w", "N", "F"), ("i", "L"), ("i", "R"), ("w", "J")],
    )  # fmt: skip
    current, speed = 1.5, 20.0
    found = derive(graph).rates({"L": 1e-3 * current, "J": 4e-4 * speed}, {"V": 12.0, "F": 5.0})
    assert found["L"] == pytest.approx(12.0 - 2.0 * current - 0.3 * speed, rel=1e-14)
    assert found["J"] == pytest.approx(0.3 * current - 0.1 * 5.0, rel=1e-14)


def test_coupled_inertias_add_by_the_square_of_the_ratio() -> None:
    """Two discs on a gear 1:3 have one state; the torque turns J_1 + 9 J_2."""
    graph = BondGraph.of(
        [Se(name="torque"), One(name="w"), I(name="one", inertia=0.2), TF(name="gear", ratio=3.0),
         I(name="two", inertia=0.05)],
        [("torque", "w", "gear", "two"), ("w", "one")],
    )  # fmt: skip
    equations = derive(graph)
    assert (equations.states, equations.causality.dependent) == (("one",), ("two",))
    acceleration = equations.rates({"one": 0.0}, {"torque": 2.0})["one"] / 0.2
    assert acceleration == pytest.approx(2.0 / (0.2 + 9 * 0.05), rel=1e-14)


def test_a_moving_inertia_keeps_its_energy() -> None:
    """A pendulum as components of velocity: (J + m l^2) q'' = -m g l cos q, whatever its speed."""
    equations = derive(pendulum())
    for angle, speed in [(0.3, 0.0), (1.2, 4.0), (-2.0, -7.0)]:
        found = equations.rates({"hub": 0.1 * speed, "angle": angle})
        assert found["angle"] == pytest.approx(speed, rel=1e-15)
        expected = -3.0 * 9.8 * 0.4 * np.cos(angle) / (0.1 + 3.0 * 0.4**2)
        assert found["hub"] / 0.1 == pytest.approx(expected, rel=1e-12)


def test_no_power_is_lost_at_junctions_and_transformers() -> None:
    graph = pendulum()
    values = derive(graph).bond_values({"hub": 0.2, "angle": 0.7})
    for element in graph.elements:
        if element.num_bonds != 1:
            powers = [b.sign(element.name) * values[b][0] * values[b][1] for b in graph.at[element.name]]
            assert sum(powers) == pytest.approx(0.0, abs=1e-13 * sum(map(abs, powers)))


def test_a_resistor_answers_an_effort_by_its_inverse() -> None:
    """Two dampers in series on a spring: the same force, the flows add."""
    elements = [C(name="k", effort=10.0), Zero(name="F"), R(name="a", effort=2.0), R(name="b", effort=5.0)]
    found = derive(BondGraph.of(elements, [("F", "k"), ("F", "a"), ("F", "b")])).rates({"k": 0.5})
    assert found["k"] == pytest.approx(-(5.0 / 2.0 + 5.0 / 5.0), rel=1e-14)
    lawless = [*elements[:3], R(name="b", effort=np.tanh)]
    with pytest.raises(ParameterError, match="R b: its effort is imposed; expected the inverse"):
        derive(BondGraph.of(lawless, [("F", "k"), ("F", "a"), ("F", "b")])).rates({"k": 0.5})


def test_strokes_stand_where_the_effort_arrives() -> None:
    graph = BondGraph.of(CART, CART_CHAINS)
    stroke = {b.head: end for b, end in causality(graph).stroke.items()}
    assert stroke == {"mass": "mass", "spring": "v", "damper": "v"}


@pytest.mark.parametrize(
    ("elements", "chains", "told"),
    [
        ([*CART, One(name="v")], CART_CHAINS, "duplicate element name 'v'"),
        (CART, [*CART_CHAINS, ("v", "wall")], "no element 'wall'"),
        (CART, [*CART_CHAINS, ("v", "mass")], "duplicate bond"),
        ([*CART, TF(name="gear", ratio=2.0)], [*CART_CHAINS, ("v", "gear")], "TF gear: 1 bonds; expected 2"),
        (CART, [*CART_CHAINS[1:], ("mass", "v")], "I mass: its bond leaves it"),
        ([*CART, MTF(name="m", ratio=np.cos, of="q"), R(name="r", effort=1.0)], [*CART_CHAINS, ("v", "m", "r")],
         "MTF m: no position 'q'"),
    ],
)  # fmt: skip
def test_what_is_no_graph_is_refused(elements: list[Element], chains: list[tuple[str, ...]], told: str) -> None:
    with pytest.raises(ParameterError, match=told):
        BondGraph.of(elements, chains)


def test_what_has_no_equations_is_refused() -> None:
    flows = BondGraph.of([Sf(name="a"), Sf(name="b"), One(name="v")], [("a", "v"), ("b", "v")])
    with pytest.raises(ParameterError, match="Sf b: contradicts another source"):
        derive(flows)
    driven = BondGraph.of([Sf(name="a"), One(name="v"), I(name="m", inertia=1.0)], [("a", "v", "m")])
    with pytest.raises(ParameterError, match="I m: driven by a source of flow; expected a source of effort"):
        derive(driven).rates({}, {"a": 1.0})
    springs = [C(name="a", effort=1.0), C(name="b", effort=2.0), Zero(name="F")]
    with pytest.raises(ParameterError, match="C b: its displacement is forced"):
        derive(BondGraph.of(springs, [("F", "a"), ("F", "b")]))
    with pytest.raises(ParameterError, match=r"m = -1\.0: expected a positive inertia"):
        I(name="m", inertia=-1.0)


def test_a_missing_value_is_named() -> None:
    equations = derive(BondGraph.of([Se(name="F"), *CART], [("F", "v"), *CART_CHAINS]))
    with pytest.raises(ParameterError, match="state 'spring': missing; expected mass, spring"):
        equations.rates({"mass": 1.0}, {"F": 1.0})
    with pytest.raises(ParameterError, match="input 'F': missing; expected F"):
        equations.rates({"mass": 1.0, "spring": 0.0})


def test_a_drawing_shows_every_element_and_a_stroke_a_bond() -> None:
    graph = pendulum()
    ax = draw(graph, plt.figure().gca())
    assert {e.text for e in graph.elements} <= {t.get_text() for t in ax.texts}
    assert len(ax.lines) == 3 * len(graph.bonds)  # line, half arrow, stroke
    with pytest.raises(ParameterError, match="at: no place for 'hub'"):
        draw(graph, ax, at={"turn": (0.0, 0.0)})
