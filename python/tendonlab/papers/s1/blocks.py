"""Block diagrams that can be evaluated and drawn: motion (fig. 3), statics (fig. 4), force display (fig. 6) of S1."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tendonlab.errors import ParameterError
from tendonlab.mechanics.tendons import BranchLosses, Model, TendonTransmission

Shape = str  # "input", "gain", "sum", "block", "output"


@dataclass(frozen=True, kw_only=True)
class Block:
    """A block at (`x`, `y`) of a diagram: it gives `function` of the sum of its `sources`, an input what it gets."""

    name: str
    label: str
    shape: Shape
    x: float
    y: float
    sources: tuple[str, ...] = ()
    function: Callable[[np.ndarray], np.ndarray] = np.asarray


@dataclass(frozen=True)
class BlockDiagram:
    """Blocks in an order in which each follows its sources. Raises ParameterError where there is no such order."""

    blocks: tuple[Block, ...]

    def __post_init__(self) -> None:
        known: set[str] = set()
        for block in self.blocks:
            missing = set(block.sources) - known
            if missing or block.name in known:
                raise ParameterError(
                    f"block {block.name!r}: expected a new name and earlier blocks as sources, {missing}"
                )
            known.add(block.name)

    def evaluate(self, inputs: Mapping[str, ArrayLike]) -> dict[str, np.ndarray]:
        """What each block gives, from numbers or arrays at the inputs."""
        wanted = {block.name for block in self.blocks if block.shape == "input"}
        if set(inputs) != wanted:
            raise ParameterError(f"inputs {sorted(inputs)}: expected {sorted(wanted)}")
        given: dict[str, np.ndarray] = {}
        for block in self.blocks:
            if block.shape == "input":
                given[block.name] = np.asarray(inputs[block.name], dtype=float)
                continue
            total = sum((given[name] for name in block.sources), np.zeros(()))
            given[block.name] = np.asarray(block.function(np.asarray(total)))
        return given


def kinematics_diagram(transmission: TendonTransmission) -> BlockDiagram:
    """Direct kinematics: motor angles `q_m1` … to joint angles `q_1` … over the branches `S_i_j`. Source: S1 fig. 3."""
    radius, blocks = transmission.radius, []
    for i in range(transmission.num_joints):
        y, r = -2.0 * i, float(transmission.motor_radius[i])
        blocks.append(Block(name=f"q_m{i + 1}", label=rf"$q_m^{i + 1}$", shape="input", x=0.0, y=y))
        blocks.append(_gain(f"S_{i + 1}_0", rf"$r_m^{i + 1}$", r, x=1.2, y=y, sources=(f"q_m{i + 1}",)))
        for j in range(i):
            x = _column(j) + 0.8 * (i - j - 1)
            gain = _gain(
                f"take_{i + 1}_{j + 1}", rf"$-r_{j + 1}^{i + 1}$", -float(radius[i, j]), x=x, y=y + 0.95,
                sources=(f"q_{j + 1}",),
            )  # fmt: skip
            sources = (f"S_{i + 1}_{j}", gain.name)
            total = Block(name=f"S_{i + 1}_{j + 1}", label=r"$\Sigma$", shape="sum", x=x, y=y, sources=sources)
            blocks += [gain, total]
        last, inverse = f"S_{i + 1}_{i}", 1.0 / float(radius[i, i])
        blocks.append(_gain(f"q_{i + 1}", rf"$1/r_{i + 1}^{i + 1}$", inverse, x=_column(i) - 1.1, y=y, sources=(last,)))
        out = Block(
            name=f"joint_{i + 1}", label=rf"$q_{i + 1}$", shape="output", x=_column(transmission.num_joints), y=y,
            sources=(f"q_{i + 1}",),
        )  # fmt: skip
        blocks.append(out)
    return BlockDiagram(tuple(blocks))


def _column(joint: int) -> float:
    return 3.6 + 2.6 * joint


def _gain(name: str, label: str, factor: float, *, x: float, y: float, sources: tuple[str, ...]) -> Block:
    return Block(name=name, label=label, shape="gain", x=x, y=y, sources=sources, function=lambda value: factor * value)


def statics_diagram(
    transmission: TendonTransmission, joint_velocity: ArrayLike, *, model: Model = "full"
) -> BlockDiagram:
    """Inverse statics in one state of motion, joint velocities (n,), rad/s: torques `C_1` … that the joints need, over
    the tensions `tau_i_j`, to motor torques `C_m1` …. A loss block gives the tension before its link from that behind.
    Source: S1 fig. 4."""
    n, radius = transmission.num_joints, transmission.radius
    velocity = np.asarray(joint_velocity, dtype=float)
    speed = transmission.kinematics.branches(velocity)
    blocks = []
    for j in reversed(range(n)):
        x, y = 3.9 * (n - 1 - j), -2.0 * j
        blocks.append(Block(name=f"C_{j + 1}", label=rf"$C_{j + 1}^E$", shape="input", x=x, y=y + 1.5))
        crossing = []
        for k in range(j + 1, n):
            blocks.append(_loss(transmission, k, j + 1, float(speed[k, j + 1]), model, x=x - 1.5, y=-2.0 * k))
            crossing.append(
                _gain(
                    f"give_{k + 1}_{j + 1}", rf"$-r_{j + 1}^{k + 1}$", -float(radius[k, j]),
                    x=x - 0.65 * (k - j - 1), y=-2.0 * k + 0.95, sources=(f"tau_{k + 1}_{j + 1}",),
                )
            )  # fmt: skip
        own = Block(
            name=f"own_{j + 1}", label=r"$\Sigma$", shape="sum", x=x, y=y,
            sources=(f"C_{j + 1}", *(gain.name for gain in crossing)),
        )  # fmt: skip
        blocks += [*crossing, own, _driven(transmission, j, float(velocity[j]), x=x + 1.1, y=y)]
    end = 3.9 * n - 1.5
    for k in range(n):
        y = -2.0 * k
        blocks.append(_loss(transmission, k, 0, float(speed[k, 0]), model, x=end, y=y))
        blocks.append(
            _gain(
                f"motor_{k + 1}", rf"$r_m^{k + 1}$", float(transmission.motor_radius[k]), x=end + 1.2, y=y,
                sources=(f"tau_{k + 1}_0",),
            )
        )  # fmt: skip
        out = Block(
            name=f"C_m{k + 1}", label=rf"$C_m^{k + 1}$", shape="output", x=end + 2.3, y=y, sources=(f"motor_{k + 1}",)
        )
        blocks.append(out)
    return BlockDiagram(tuple(blocks))


def _loss(
    transmission: TendonTransmission, k: int, link: int, speed: float, model: Model, *, x: float, y: float
) -> Block:
    """Tension before a link from that behind it: a transmission of its own, of radius 1, with that one branch."""
    losses = {name: np.array([[getattr(transmission.losses, name)[k, link]]]) for name in _LOSSES}
    one = TendonTransmission(radius=np.ones((1, 1)), motor_radius=np.ones(1), losses=BranchLosses(**losses))

    def before(behind: np.ndarray) -> np.ndarray:
        return one.statics.inverse(behind[..., None], np.array([speed]), model=model).torque[..., 0]

    return Block(
        name=f"tau_{k + 1}_{link}", label=rf"$+\Delta\tau_{link}^{k + 1}$", shape="block", x=x, y=y,
        sources=(f"tau_{k + 1}_{link + 1}",), function=before,
    )  # fmt: skip


def _driven(transmission: TendonTransmission, j: int, velocity: float, *, x: float, y: float) -> Block:
    """The driven pulley, with its reducer."""
    arm, reducer = float(transmission.radius[j, j]), transmission.reducers[j]

    def tension(torque: np.ndarray) -> np.ndarray:
        if reducer is None:
            return torque / arm
        return reducer.input_torque(torque, velocity) * reducer.ratio / arm

    label = rf"$1/r_{j + 1}^{j + 1}$" + ("" if reducer is None else r"$,\ \eta$")
    return Block(
        name=f"tau_{j + 1}_{j + 1}", label=label, shape="gain", x=x, y=y, sources=(f"own_{j + 1}",), function=tension
    )


_LOSSES = ("constant", "tension", "viscous")

# The blocks of fig. 6: `display.ForceDisplay.command` passes through them in this order.
CONTROL_SCHEME = BlockDiagram(
    (
        Block(name="motors", label="motors and\nencoders", shape="input", x=0.0, y=0.0),
        Block(name="direct kinematics", label="direct\nkinematics", shape="block", x=2.3, y=0.0, sources=("motors",)),
        Block(
            name="arm", label="arm\n" + r"$\hat q,\ \hat X,\ J$", shape="block", x=4.6, y=0.0,
            sources=("direct kinematics",),
        ),
        Block(name="proxy", label="proxy\n" + r"$X_{god}$", shape="block", x=6.9, y=0.0, sources=("arm",)),
        Block(name="spring", label=r"$K_{st} + K_d\,s$", shape="block", x=9.0, y=0.8, sources=("proxy",)),
        Block(name="surface", label="friction,\ntexture", shape="block", x=9.0, y=-0.8, sources=("proxy",)),
        Block(name="force", label=r"$\Sigma$", shape="sum", x=10.8, y=0.0, sources=("spring", "surface")),
        Block(name="torque", label=r"$J^T$", shape="gain", x=12.0, y=-3.0, sources=("force",)),
        Block(name="gravity", label="gravity", shape="block", x=4.6, y=-1.6, sources=("arm",)),
        Block(name="load", label=r"$\Sigma$", shape="sum", x=6.9, y=-3.0, sources=("torque", "gravity")),
        Block(
            name="feed-forward", label="feed-forward\n(fig. 4)", shape="block", x=2.3, y=-3.0,
            sources=("load", "direct kinematics"),
        ),
        Block(name="command", label="motor\ntorques", shape="output", x=0.0, y=-3.0, sources=("feed-forward",)),
    )
)  # fmt: skip
