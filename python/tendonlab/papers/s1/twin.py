"""A twin of the device that shares no law with the library: the recursion of S1 fig. 4 in closed form, with all losses.
It makes the logs on which a loss is withheld and diagnosed: that in proportion to tension, which the paper leaves out,
or that of the reducers; or on which the simulator believes wrong radii."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from tendonlab.arguments import choice, positive, samples
from tendonlab.data import NominalParameter
from tendonlab.mechanics.tendons import TendonTransmission
from tendonlab.papers.s1.device import GRAVITY, LOAD_LEVELS, example_device
from tendonlab.papers.s1.identification import decompose, identify_joint, shares_by_bearings
from tendonlab.seed import generator

NOISE = 5e-3  # N·m, of a motor torque [reconstructed]
RUN_TO_RUN = 0.005  # relative sd of all losses from run to run [reconstructed]
SAMPLE_TIME, DURATION = 0.04, 10.0  # s
WITHHELD = ("tension", "reducer", "radius")
DRIVEN_RADII = tuple(f"radius_{i}_{i}" for i in range(1, 5))


def inverse_statics(
    device: TendonTransmission, joint_torque: np.ndarray, joint_velocity: np.ndarray, *, scale: float = 1.0
) -> np.ndarray:
    """Motor torques (m, n), N·m, that give `joint_torque` at `joint_velocity`, with every loss times `scale`."""
    radius, n = device.radius, device.num_joints
    constant, tension, viscous = (scale * getattr(device.losses, name) for name in ("constant", "tension", "viscous"))
    speed = np.zeros((*joint_velocity.shape, n))
    for i in range(n):
        for j in range(i + 1):
            speed[..., i, j] = sum(radius[i, k] * joint_velocity[..., k] for k in range(j, i + 1))

    def before(i: int, link: int, behind: np.ndarray) -> np.ndarray:
        v = speed[..., i, link]
        b = behind + constant[i, link] * np.sign(v) + viscous[i, link] * v
        return np.asarray(b / (1 - tension[i, link] * np.sign(v) * np.sign(b)))

    at = np.zeros((*joint_torque.shape, n + 1))
    for j in reversed(range(n)):
        own = joint_torque[..., j]
        for k in range(j + 1, n):
            at[..., k, j + 1] = before(k, j + 1, at[..., k, j + 2])
            own = own - at[..., k, j + 1] * radius[k, j]
        at[..., j, j + 1] = _through_reducer(device, j, own, joint_velocity[..., j]) / radius[j, j]
    motors = [device.motor_radius[k] * before(k, 0, at[..., k, 1]) for k in range(n)]
    return np.stack(motors, axis=-1)


def _through_reducer(device: TendonTransmission, j: int, torque: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    reducer = device.reducers[j]
    if reducer is None:
        return torque
    eta = reducer.efficiency
    return np.where(torque * velocity >= 0, torque / eta, torque * (2 - 1 / eta))


@dataclass(frozen=True, kw_only=True)
class Session:
    """One experiment of the twin: gravity times `level`, joints on sinusoids of `frequency`, Hz, and `phase`, rad."""

    name: str
    level: float
    frequency: tuple[float, ...]
    phase: tuple[float, ...]
    split: str
    repeat: str | None = None


def sessions(levels: Sequence[float] = LOAD_LEVELS) -> list[Session]:
    """Two motions at each level of gravity to fit, one of them three times, and a third motion held out at each."""
    middle = sorted(levels)[len(levels) // 2]
    motions = {
        "a": ((0.25, 0.20, 0.30, 0.35), (0.0, 0.4, 0.8, 1.2)),
        "b": ((0.15, 0.35, 0.22, 0.28), (1.0, 0.0, 2.0, 0.5)),
        "c": ((0.32, 0.24, 0.18, 0.40), (2.1, 1.3, 0.3, 0.0)),
    }
    found = []
    for level in levels:
        for motion, (frequency, phase) in motions.items():
            repeated = motion == "a" and level == middle
            for take in range(3 if repeated else 1):
                found.append(
                    Session(
                        name=f"gravity-x{level:g}-{motion}" + (f"-{take + 1}" if repeated else ""), level=level,
                        frequency=frequency, phase=phase, split="test" if motion == "c" else "train",
                        repeat="A" if repeated else None,
                    )
                )  # fmt: skip
    return found


def record(device: TendonTransmission, of: Session, rng: np.random.Generator) -> pd.DataFrame:
    """What the twin logs in one session, indexed by time, s."""
    time = np.arange(0.0, DURATION, SAMPLE_TIME)[:, None]
    turn = 2 * np.pi * np.array(of.frequency)
    amplitude = np.array([0.5, 0.35, 0.4, 0.5])  # rad
    angle = amplitude * np.sin(turn * time + of.phase)
    velocity = amplitude * turn * np.cos(turn * time + of.phase)
    turned = [np.sin(angle[:, 0]), np.cos(angle[:, 1]), np.sin(angle[:, 2]), np.cos(angle[:, 3])]
    load = of.level * GRAVITY * np.stack(turned, axis=-1)
    torque = inverse_statics(device, load, velocity, scale=float(np.exp(RUN_TO_RUN * rng.standard_normal())))
    torque = torque + NOISE * rng.standard_normal(torque.shape)
    motor = velocity @ device.radius.T / device.motor_radius
    columns = {"motor_velocity": motor, "external_torque": load, "motor_torque": torque}
    data = {f"{name}_{i + 1}": values[:, i] for name, values in columns.items() for i in range(4)}
    return pd.DataFrame(data, index=pd.Index(time[:, 0], name="t"))


def nominal_device() -> TendonTransmission:
    """The simulator as the paper's procedure leaves it: motor friction by strategy S2, shared out over the branches as
    if each had as many bearings, no loss in proportion to tension (S1 eqs 12, 18-21)."""
    device = example_device()
    n = device.num_joints
    constant, viscous = np.zeros((n, n)), np.zeros((n, n))
    for i in range(n):
        found = identify_joint(device, i + 1, strategy="S2", speeds=(-6, -4, -2, 2, 4, 6))
        shares = shares_by_bearings([1] * (i + 1))
        arm = np.full(i + 1, device.motor_radius[i])
        split = decompose(found.constant, found.viscous, arm, shares_static=shares, shares_viscous=shares)
        constant[i, : i + 1], viscous[i, : i + 1] = split.constant, split.viscous
    losses = replace(device.losses, constant=constant, viscous=viscous, tension=np.zeros((n, n)))
    return replace(device, losses=losses)


def believed(withheld: str) -> dict[str, NominalParameter]:
    """What the simulator knows: "tension", friction as the paper identifies it, without loss in proportion to tension;
    "reducer", all losses of the branches, and reducers that lose nothing; "radius", everything, but the driven pulleys
    of joints 2 and 3 count as 2 % larger than they are, and all driven pulleys are known to 2 %.

    Raises ParameterError for another word."""
    choice("withheld", withheld, WITHHELD)
    own = (nominal_device() if withheld == "tension" else example_device()).parameters()
    known = {}
    for name, value in own.items():
        uncertain = value > 0 and name.startswith(("constant_loss", "viscous_loss"))
        sd = 0.3 * value if uncertain else 0.0
        if withheld == "reducer" and name.startswith("reducer_efficiency"):
            value = 1.0
        if withheld == "radius" and name in DRIVEN_RADII:
            sd = 0.02 * value
            value *= 1.02 if name in DRIVEN_RADII[1:3] else 1.0
        known[name] = NominalParameter(value, sd=sd)
    return known


def write_dataset(
    folder: str | Path, *, levels: Sequence[float] = LOAD_LEVELS, seed: int = 0, withheld: str = "tension"
) -> Path:
    """Write the twin's logs at `levels` of gravity and the simulator that lacks what is `withheld` (`believed`), as
    a dataset folder."""
    for k, level in enumerate(samples("levels", levels)):
        positive(f"levels[{k}]", level)
    target, rng = Path(folder), generator(seed)
    target.mkdir(parents=True, exist_ok=True)
    lines = [
        'format = "tendonlab-dataset/1"',
        'name = "s1-twin"',
        'description = "Twin of the reconstructed arm of S1; generated, not measured"',
        "[system]",
        'kind = "tendon_routing"',
        "[system.parameters]",
    ]
    lines += [f"{name} = {{ value = {p.value!r}, sd = {p.sd!r} }}" for name, p in believed(withheld).items()]
    lines.append("[signals]")
    for name, unit in (("motor_velocity", "rad/s"), ("external_torque", "N*m"), ("motor_torque", "N*m")):
        lines += [f'{name}_{i} = {{ column = "{name}_{i}", unit = "{unit}" }}' for i in range(1, 5)]
    for of in sessions(levels):
        record(example_device(), of, rng).to_csv(target / f"{of.name}.csv", float_format="%.9g")
        lines += ["[[experiments]]", f'name = "{of.name}"', f'file = "{of.name}.csv"', f'split = "{of.split}"']
        lines += [f'repeat = "{of.repeat}"'] if of.repeat else []
    (target / "dataset.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return target
