"""An independent twin of the rig: the cable as a chain of elastic pieces with a friction node between each two.

    J_A v_A' = tau_in - b_A v_A - e_0,     J_B v_B' = e_n - K_p q_B - K_d v_B
    e_i = k (q_i - q_(i+1)),  q_0 = q_A, q_(n+1) = q_B,  k = (n + 1) 2 EA r²/L
    d v_i = e_(i-1) - e_i - F_i z_i/z_0,     z_i' = v_i - |v_i| z_i/(z_0 g(v_i))
    g = 1 + (mu_s/mu_d - 1) exp(-(v_i/v_s)²)
    F_i = 2 r T_s (exp(-mu_d phi_i) - exp(-mu_d phi_(i+1))),  so that they add up to the model's offset

Friction here acts along the cable while the cable stretches, without a velocity gate; the paper's model lacks this.
The twin shares no law and no stepper with the library. Reconstructed: these are not the data of the paper's rig."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from scipy.integrate import ODEintWarning, odeint

from tendonlab.errors import NumericalError, ParameterError
from tendonlab.papers.s3.rig import DEGREE, FrictionParameters, Rig, assumed_rig, paper_parameters
from tendonlab.papers.s3.shapes import BumpShape
from tendonlab.papers.s3.trajectories import Trajectory
from tendonlab.procedures.sheath_shape import Shape

TORQUE_NOISE_SD, VELOCITY_NOISE_SD = 0.15, 0.05  # N·m; deg/s
SUCCESS = "Integration successful."  # as odeint says it
MOST_STEPS = 100_000  # of the integrator from one sample to the next


@dataclass(frozen=True, kw_only=True)
class Chain:
    """A rig with its cable as `num_nodes` friction nodes. `pretension`: T_s, N, as the load cells read it.

    `slack`: where the pulling cable carries more than both together did at rest, the other one is loose and friction
    grows with the torque. `tension_drop`: the sum of both tensions, and friction with it, falls along a sliding sheath
    by mu e/r per rad and keeps its mean, since the cables keep their length (eq. 6, 10, 12, 13); this matters for
    shapes that are not the same from both ends. `pretension_scale`: true pretension over the reading.
    `bristle_length`: z_0, rad; `node_damping`: d, N·m·s/rad."""

    shape: Shape | BumpShape
    pretension: float
    friction: FrictionParameters = field(default_factory=paper_parameters)
    rig: Rig = field(default_factory=assumed_rig)
    num_nodes: int = 10
    bristle_length: float = 4e-3
    node_damping: float = 0.05
    slack: bool = False
    tension_drop: bool = False
    pretension_scale: float = 1.0

    def __post_init__(self) -> None:
        if self.num_nodes < 1 or not self.pretension > 0 or not self.pretension_scale >= 0:
            raise ParameterError(
                f"num_nodes = {self.num_nodes}, pretension = {self.pretension} N, pretension_scale = "
                f"{self.pretension_scale}: expected at least one node, a positive pretension and a scale >= 0"
            )
        if self.rig.r_in != self.rig.r_out:
            raise ParameterError(f"r_in = {self.rig.r_in}, r_out = {self.rig.r_out} m: the chain expects equal radii")

    def node_turning(self) -> np.ndarray:
        """phi at the borders of the nodes' even stretches, rad, (num_nodes + 1,)."""
        if isinstance(self.shape, BumpShape):
            return np.asarray(self.shape.turning(np.linspace(0.0, self.shape.length, self.num_nodes + 1)))
        s = np.linspace(0.0, self.shape.length, self.num_nodes + 1)
        return np.asarray(np.interp(s, self.shape.arc_length, self.shape.turning))

    def simulate(
        self,
        trajectory: Trajectory,
        *,
        duration: float,
        sample_rate: float = 200.0,
        seed: int | np.random.Generator | None = 0,
        rtol: float = 1e-6,
        atol: float = 1e-9,
        longest_step: float = 0.02,
    ) -> pd.DataFrame:
        """From rest under `trajectory` for `duration`, s: a frame by time "t", s, with `tau_in` and `tau_out`, N·m, and
        `v`, deg/s, of motor A; `tau_out` and `v` with noise unless `seed` is None. By scipy's
        LSODA. Raises NumericalError where the integration fails."""
        time = np.arange(round(duration * sample_rate)) / sample_rate
        equations = ChainEquations.of(self, trajectory)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ODEintWarning)  # said by the error below
            states, report = odeint(
                equations.rate, np.zeros(equations.size), time, Dfun=equations.jacobian, tfirst=True, rtol=rtol,
                atol=atol, hmax=longest_step, mxstep=MOST_STEPS, full_output=True,
            )  # fmt: skip
        if len(time) > 1 and report["message"] != SUCCESS:  # what was not reached is not set: only the message tells
            raise NumericalError(f"the chain could not be integrated under {trajectory}: {report['message']}")
        end = states @ equations.stretching[-1]
        columns = {"tau_in": trajectory.torque(time), "v": states[:, 1] / DEGREE, "tau_out": end}
        log = pd.DataFrame(columns, index=pd.Index(time, name="t"))
        return log if seed is None else with_noise(log, seed=seed)


def with_noise(log: pd.DataFrame, *, seed: int | np.random.Generator) -> pd.DataFrame:
    """A log of the chain as its sensors see it: `tau_out` with noise of 0.15 N·m, `v` of 0.05 deg/s."""
    rng = np.random.default_rng(seed)
    torque, speed = (rng.normal(0.0, sd, len(log)) for sd in (TORQUE_NOISE_SD, VELOCITY_NOISE_SD))
    return log.assign(tau_out=log["tau_out"] + torque, v=log["v"] + speed)


@dataclass(frozen=True, eq=False)
class ChainEquations:
    """Right-hand side and Jacobian. State: q_A, v_A, q_1 … q_n, z_1 … z_n, q_B, v_B."""

    chain: Chain
    trajectory: Trajectory
    stiffness: float
    level: np.ndarray  # F_i without slack, N·m
    share: np.ndarray  # of the torque passing a node that is lost there where a cable is loose
    drop: np.ndarray  # d F_i / d friction-weighted torque at each node, which makes the tensions fall, (n, n)
    ratio: float
    stribeck: float
    stretching: np.ndarray  # d e / d state, (n + 1, size)

    @classmethod
    def of(cls, chain: Chain, trajectory: Trajectory) -> ChainEquations:
        rig, p, n = chain.rig, chain.friction.in_unit("rad/s"), chain.num_nodes
        phi = chain.node_turning()
        k = (n + 1) * 2.0 * rig.EA * rig.r_in**2 / rig.L
        torque = 2.0 * rig.r_in * chain.pretension * chain.pretension_scale
        positions = np.array([0, *range(2, n + 2), 2 * n + 2])
        stretching = np.zeros((n + 1, 2 * n + 4))
        stretching[np.arange(n + 1), positions[:-1]] = k
        stretching[np.arange(n + 1), positions[1:]] = -k
        left, bent = np.exp(-p.mu_d * phi), p.mu_d * np.diff(phi)  # left: of the pretension, when it was set
        even = 0.5 * float(np.mean(left[1:] + left[:-1])) * bent
        return cls(
            chain=chain, trajectory=trajectory, stiffness=k,
            level=torque * (even if chain.tension_drop else -np.diff(left)),
            share=1.0 - np.exp(-bent), drop=_drop(bent) if chain.tension_drop else np.zeros((n, n)),
            ratio=p.mu_s / p.mu_d - 1.0, stribeck=p.v_s, stretching=stretching,
        )  # fmt: skip

    @property
    def size(self) -> int:
        return 2 * self.chain.num_nodes + 4

    def nodes(self, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Torques e, friction levels F, speeds v of the nodes, and their bristles z."""
        n = self.chain.num_nodes
        e, z = self.stretching @ y, y[n + 2 : 2 * n + 2]
        level = np.maximum(self.level, np.abs(e[:-1]) * self.share) if self.chain.slack else self.level
        if self.chain.tension_drop:
            level = level - self.drop @ (z / self.chain.bristle_length * 0.5 * (e[:-1] + e[1:]))
        v = (e[:-1] - e[1:] - level * z / self.chain.bristle_length) / self.chain.node_damping
        return e, level, v, z

    def rate(self, t: float, y: np.ndarray) -> np.ndarray:
        rig, n = self.chain.rig, self.chain.num_nodes
        e, _, v, z = self.nodes(y)
        g = 1.0 + self.ratio * np.exp(-((v / self.stribeck) ** 2))
        rate = np.empty_like(y)
        rate[0], rate[1] = y[1], (float(self.trajectory.torque(t)) - rig.b_A * y[1] - e[0]) / rig.J_A
        rate[2 : n + 2] = v
        rate[n + 2 : 2 * n + 2] = v - np.abs(v) * z / (self.chain.bristle_length * g)
        rate[-2], rate[-1] = y[-1], (e[-1] - rig.K_p * y[-2] - rig.K_d * y[-1]) / rig.J_B
        return rate

    def jacobian(self, _: float, y: np.ndarray) -> np.ndarray:
        rig, n = self.chain.rig, self.chain.num_nodes
        e, level, v, z = self.nodes(y)
        z_0, d, i = self.chain.bristle_length, self.chain.node_damping, np.arange(n)
        peak = self.ratio * np.exp(-((v / self.stribeck) ** 2))
        g = 1.0 + peak
        g_slope = -2.0 * v / self.stribeck**2 * peak
        speed = (self.stretching[:-1] - self.stretching[1:]) / d
        speed[i, n + 2 + i] -= level / (z_0 * d)
        if self.chain.slack:
            loose = np.abs(e[:-1]) * self.share > self.level
            speed -= (loose * np.sign(e[:-1]) * self.share * z / (z_0 * d))[:, None] * self.stretching[:-1]
        if self.chain.tension_drop:
            passing = 0.5 * (z / z_0)[:, None] * (self.stretching[:-1] + self.stretching[1:])
            passing[i, n + 2 + i] += 0.5 * (e[:-1] + e[1:]) / z_0
            speed += (z / (z_0 * d))[:, None] * (self.drop @ passing)
        jacobian = np.zeros((self.size, self.size))
        jacobian[0, 1] = 1.0
        jacobian[1] = -self.stretching[0] / rig.J_A
        jacobian[1, 1] -= rig.b_A / rig.J_A
        jacobian[2 : n + 2] = speed
        along = 1.0 - np.sign(v) * z / (z_0 * g) + np.abs(v) * z * g_slope / (z_0 * g**2)
        jacobian[n + 2 : 2 * n + 2] = along[:, None] * speed
        jacobian[n + 2 + i, n + 2 + i] -= np.abs(v) / (z_0 * g)
        jacobian[-2, -1] = 1.0
        jacobian[-1] = self.stretching[-1] / rig.J_B
        jacobian[-1, -2] -= rig.K_p / rig.J_B
        jacobian[-1, -1] -= rig.K_d / rig.J_B
        return jacobian


def _drop(bent: np.ndarray) -> np.ndarray:
    """By how much the friction of node i is less for the torque at node j, where it slides: `bent` is mu times the
    angle turned at each node. What precedes a node counts in full, its own half, and the mean is made good."""
    before = np.tri(len(bent), k=-1) + 0.5 * np.eye(len(bent))
    return np.asarray(bent[:, None] * (before - before.mean(axis=0)) * bent)
