"""What the load of a slot is measured in decides what friction per load is: a ratio, or an effort under a ratio."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from examples import with_effect
from tendonlab.diagnosis.answer.where import dimension
from tendonlab.fitting.priors import scales
from tendonlab.simulation.catalog import ParameterInfo, SystemInfo, parameter_unit, unit
from tendonlab.simulation.prepare import Replay, prepare

CARRIED = [
    (info, p) for kind in tl.kinds() for info in [tl.system_info(kind)] for p in info.parameters
    if p.own == "load_dependence" and kind != "friction_map"
]  # fmt: skip


@pytest.mark.parametrize(("info", "p"), CARRIED, ids=[f"{info.kind}:{p.name}" for info, p in CARRIED])
def test_under_an_effort_it_is_a_ratio_of_at_most_one(info: SystemInfo, p: ParameterInfo) -> None:
    assert (p.dimension, parameter_unit(info, p, "rotary"), parameter_unit(info, p, "linear")) == ("ratio", "1", "1")
    assert (p.lower, p.upper) == (0.0, 1.0)


def loaded(load_dependence: float = 0.0) -> tl.System:
    off = with_effect("friction_map", "contact:load_dependence", off=True)
    return off.with_parameters({"contact_load_dependence": load_dependence})


def test_under_a_relative_load_it_is_an_effort_without_bound() -> None:
    system = loaded(2.5)
    p = system.info.parameter("contact_load_dependence")
    assert (p.dimension, p.upper) == ("effort", np.inf)
    assert system.unit("contact_load_dependence") == "N*m"
    assert replace(system, axis="linear").unit("contact_load_dependence") == "N"
    with pytest.raises(tl.ParameterError, match=r"contact_load_dependence = -1.0: expected .* \[0, inf\) N\*m"):
        loaded(-1.0)


def test_a_newton_metre_per_load_is_one_for_each_unit_of_load() -> None:
    points = pd.DataFrame({"speed": [-3.0, 2.0]}, index=pd.Index([0.0, 1.0], name="t"))
    for load in (1.0, 4.0):
        with_it, without = (
            of.with_parameters({"relative_load": load}).simulate(points)["friction_torque"].to_numpy()
            for of in (loaded(2.5), loaded())
        )
        np.testing.assert_allclose(with_it - without, [-2.5 * load, 2.5 * load], rtol=1e-12)


@pytest.mark.parametrize("load", [1.0, 40.0])
def test_priors_scale_with_friction_and_not_with_a_load_of_another_unit(load: float) -> None:
    """The effort of a slot under a relative load is its friction."""
    system = loaded().with_parameters({"relative_load": load})
    points = pd.DataFrame({"speed": np.linspace(1.0, 9.0, 5)}, index=pd.Index(np.arange(5.0), name="t"))
    friction = system.simulate(points)["friction_torque"].to_numpy()
    experiment = tl.Experiment(name="map", data=points.assign(friction_torque=friction))
    found = scales(system, [prepare(experiment, system, Replay("free"))])["contact"]
    assert found.effort == pytest.approx(np.sqrt(np.mean(friction**2)), rel=1e-9)


@pytest.mark.parametrize(
    ("kind", "port", "shown"), [("friction_map", "contact", "1"), ("two_inertia", "contact", "N*m")]
)
def test_a_load_is_shown_in_its_own_unit(kind: str, port: str, shown: str) -> None:
    of = next(p for p in tl.system_info(kind).ports if p.name == port)
    assert unit(dimension(of, "load"), "rotary") == shown
