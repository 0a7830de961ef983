"""How long a mass with LuGre friction takes, against numbalsoda at the same error, and what its exact gradient costs.

A mass of 1 kg under 2 N sin(2 pi t) with Coulomb, viscous and Stribeck friction and presliding, over 1 s, at 1 kHz.
Run: python tests/benchmarks/lugre_mass.py [rounds]; needs numba and numbalsoda, which tendonlab itself does not.

Errors are the larger of those of position and friction force, root mean square over that of a reference, which is the
peer's own at a tolerance of 1e-12. Each tool runs at the loosest of its settings from which on all tighter ones keep
the error asked for; its calls alternate with those of the others, and the time is that of the process. The peer gets
the command as a formula and need not work out the friction force. It takes one absolute tolerance for all states: once
the deflection stays in metres and the tolerance follows it, once it is counted in breakaway displacements."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from tendonlab import _core
from tendonlab.simulation.signals import smooth
from tendonlab.simulation.system import System

TIME = np.linspace(0.0, 1.0, 1001)
MASS, AMPLITUDE = 1.0, 2.0
FRICTION = {
    "coulomb": 1.0,
    "viscous": 0.4,
    "joint_static_excess": 0.5,
    "joint_stribeck_velocity": 1e-3,
    "joint_bristle_stiffness": 1e5,
    "joint_bristle_damping": 1e5**0.5,
}
BREAKAWAY = FRICTION["coulomb"] / FRICTION["joint_bristle_stiffness"]  # the scale of the bristle's deflection, m
ERROR = 1e-3
TOLERANCES = 10.0 ** -np.arange(2.0, 7.01, 0.25)

Answer = tuple[np.ndarray, np.ndarray]  # position and friction force, (samples,)


def ours(tolerance: float, *, ports: bool = True, gradient: bool = False) -> Callable[[], Any]:
    """One call of the core; `ports` records the friction force, `gradient` differentiates by the six of FRICTION."""
    system = System(
        kind="rigid_joint",
        axis="linear",
        parameters={"inertia": MASS, "gravity_torque": 0.0, "torque_constant": 1.0, **FRICTION},
        effects=("joint:coulomb", "joint:viscous", "joint:stribeck", "joint:presliding"),
    )
    names = [p.name for p in system.info.parameters]
    experiment = _core.Experiment(
        kind=system.kind,
        time=TIME.tolist(),
        inputs=[smooth(TIME, AMPLITUDE * np.sin(2 * np.pi * TIME)), _core.Signal()],
        loop=_core.Loop(),
        position=[0.0],
        velocity=[0.0],
    )
    seeds = [("parameter", names.index(name)) for name in FRICTION] if gradient else []
    settings = _core.Settings(tolerance=tolerance, ports=ports)
    return partial(_core.simulate, system.kind, system.values(), system.active(), experiment, seeds, settings)


def our_answer(done: dict[str, Any]) -> Answer:
    return done["outputs"][0], done["ports"][0][3]


def peer(tolerance: float, *, rate: Any, unit: float) -> Callable[[], Any]:
    """One call of numbalsoda with the deflection in units of `unit`, in m; `rate` from `peer_rate`."""
    from numbalsoda import lsoda

    values = np.array([MASS, AMPLITUDE, unit, *FRICTION.values()])
    return partial(
        lsoda, rate.address, np.zeros(3), TIME, data=values, rtol=tolerance, atol=tolerance * BREAKAWAY / unit
    )


def peer_rate() -> Any:
    """The same mass for numbalsoda, compiled: position, velocity, and deflection in a unit of one's choice."""
    import numba
    from numbalsoda import lsoda_sig

    @numba.cfunc(lsoda_sig)
    def rate(t, state, change, given):  # type: ignore[no-untyped-def]
        y, d, p = numba.carray(state, (3,)), numba.carray(change, (3,)), numba.carray(given, (9,))
        mass, amplitude, unit, coulomb, viscous, excess, fade, stiffness, damping = p
        v, z = y[1], unit * y[2]
        level = coulomb + excess * np.exp(-((v / fade) ** 2))
        bristle = v - stiffness * abs(v) * z / level
        d[0] = v
        d[1] = (amplitude * np.sin(2 * np.pi * t) - stiffness * z - damping * bristle - viscous * v) / mass
        d[2] = bristle / unit

    return rate


def peer_answer(done: tuple[np.ndarray, bool], *, unit: float) -> Answer:
    x, v, z = done[0].T * [[1.0], [1.0], [unit]]
    level = FRICTION["coulomb"] + FRICTION["joint_static_excess"] * np.exp(
        -((v / FRICTION["joint_stribeck_velocity"]) ** 2)
    )
    stiffness, damping = FRICTION["joint_bristle_stiffness"], FRICTION["joint_bristle_damping"]
    return x, stiffness * z + damping * (v - stiffness * abs(v) * z / level) + FRICTION["viscous"] * v


def error(found: Answer, reference: Answer) -> float:
    pairs = zip(found, reference, strict=True)
    return max(float(np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2))) for a, b in pairs)


def loosest(error_at: Callable[[float], float]) -> tuple[float, float]:
    """The loosest tolerance from which on the error stays within ERROR, and the error there."""
    errors = [error_at(tolerance) for tolerance in TOLERANCES]
    wrong = [i for i, e in enumerate(errors) if not e <= ERROR]
    first = wrong[-1] + 1 if wrong else 0
    return float(TOLERANCES[first]), errors[first]


def alternate(calls: list[Callable[[], Any]], *, rounds: int, repeats: int = 10) -> list[float]:
    """Median seconds of one call, of each, over rounds in which they take turns; the first round is not counted."""
    spent = np.empty((rounds + 1, len(calls)))
    for turn in range(rounds + 1):
        for i, call in enumerate(calls):
            start = time.process_time()
            for _ in range(repeats):
                call()
            spent[turn, i] = (time.process_time() - start) / repeats
    return list(np.median(spent[1:], axis=0))


@dataclass(frozen=True)
class Row:
    """A line of the table: calls at `tolerance`, compared with those of the line `over`."""

    text: str
    call: Callable[[], Any]
    tolerance: float
    error: float
    over: int


def rows() -> list[Row]:
    try:
        rate = peer_rate()
    except ImportError as missing:
        raise SystemExit(f"{missing}; this comparison needs it: pip install numba numbalsoda") from None

    def peers(tolerance: float, unit: float) -> Answer:
        return peer_answer(peer(tolerance, rate=rate, unit=unit)(), unit=unit)

    reference = peers(1e-12, BREAKAWAY)
    print(f"ours and the peer's at 1e-12 differ by {error(our_answer(ours(1e-12)()), reference):.0e}")
    found = loosest(lambda tolerance: error(our_answer(ours(tolerance)()), reference))
    table = [Row("tendonlab, position and force", ours(found[0]), *found, 0)]
    for unit, text in ((1.0, "numbalsoda, states in SI"), (BREAKAWAY, "numbalsoda, states scaled")):
        best = loosest(lambda tolerance, unit=unit: error(peers(tolerance, unit), reference))
        table.append(Row(text, peer(best[0], rate=rate, unit=unit), *best, 0))
    table.append(Row("tendonlab, position and velocity", ours(found[0], ports=False), *found, 3))
    table.append(Row("  with their gradient by six", ours(found[0], ports=False, gradient=True), *found, 3))
    return table


def main(rounds: int = 50) -> None:
    table = rows()
    seconds = alternate([row.call for row in table], rounds=rounds)
    print(f"{'':34}tolerance     error    time (us)   ratio")
    for row, spent in zip(table, seconds, strict=True):
        ratio = spent / seconds[row.over]
        print(f"{row.text:34}{row.tolerance:9.1e} {row.error:9.1e} {1e6 * spent:12.1f} {ratio:7.2f}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
