"""A joint in a robot simulator: MuJoCo's steps of 1 ms beside tendonlab's mass, per simulated millisecond.

Not the same physics: MuJoCo has dry and viscous friction without presliding and without Stribeck friction, under a
constant force. The row says what a simulated second costs, not how exact it is."""

from __future__ import annotations

import importlib.util

from benchmarks import mass, ours
from benchmarks.clock import Call, alternate
from benchmarks.options import Options
from benchmarks.table import Table, ratio_text, seconds_text

STEPS = 2000
MODEL = """<mujoco><option timestep="0.001" integrator="{integrator}" gravity="0 0 0"/><worldbody><body>
<joint name="slide" type="slide" axis="1 0 0" frictionloss="{coulomb}" damping="{viscous}"/>
<geom size="0.1" mass="1" contype="0" conaffinity="0"/></body></worldbody>
<actuator><motor joint="slide"/></actuator></mujoco>"""
INTEGRATORS = ("implicitfast", "implicit", "RK4")
COLUMNS = ("tool", "per simulated millisecond", "ratio")


def run(options: Options) -> list[Table]:
    problem = mass.driven(force=True)
    names = ["tendonlab, full LuGre friction, tolerance 1e-4"]
    calls: list[tuple[Call, int]] = [(ours.core_call(problem, 1e-4), len(problem.time) - 1)]
    notes: tuple[str, ...] = (
        "One slide joint; MuJoCo has no presliding and no Stribeck friction: not the same physics.",
    )
    if importlib.util.find_spec("mujoco") is None:
        notes += ("MuJoCo was skipped: not installed.",)
    else:
        names += [f"MuJoCo, frictionloss, {name}" for name in INTEGRATORS]
        calls += [(_steps(name), STEPS) for name in INTEGRATORS]
    spent = alternate([call for call, _ in calls], rounds=options.rounds)
    each = [seconds / steps for seconds, (_, steps) in zip(spent, calls, strict=True)]
    found = [(n, seconds_text(s), ratio_text(s / each[0])) for n, s in zip(names, each, strict=True)]
    return [Table(COLUMNS, tuple(found), notes)]


def _steps(integrator: str) -> Call:
    import mujoco

    friction = {name: mass.FRICTION[name] for name in ("coulomb", "viscous")}
    model = mujoco.MjModel.from_xml_string(MODEL.format(integrator=integrator, **friction))
    data = mujoco.MjData(model)

    def call() -> None:
        mujoco.mj_resetData(model, data)
        data.ctrl[0] = mass.AMPLITUDE
        mujoco.mj_step(model, data, STEPS)

    return call
