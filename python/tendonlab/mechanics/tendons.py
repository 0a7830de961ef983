"""Coupled tendon transmissions: how motion and tension travel from the motors over idle pulleys to the joints (S1).

Transmission i starts at its motor on the base, crosses the joints before its own over idle pulleys and ends on the
driven pulley of joint i. A tension is the difference between both runs of a loop and may be negative."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from tendonlab import _core
from tendonlab.errors import ParameterError

Model = Literal["ideal", "eq11", "eq12", "full"]
AtRest = Literal["drive", "mean", "lossless"]
LOSSES: Mapping[str, tuple[str, ...]] = {  # laws of a branch in each model
    "ideal": (),
    "eq11": ("load_dependence", "viscous"),
    "eq12": ("coulomb", "viscous"),
    "full": ("coulomb", "load_dependence", "viscous"),
}
LARGEST_SYSTEM = 4  # joints of the system `tendon_routing`


def _floats(name: str, values: ArrayLike, *, shape: tuple[int, ...] | None = None) -> np.ndarray:
    """`values` as real numbers, of `shape` where that is given."""
    try:
        given = np.asarray(values)
        array = given.astype(float, casting="unsafe" if given.dtype == object else "same_kind")
    except (TypeError, ValueError) as error:
        raise ParameterError(f"{name} = {values!r}: expected real numbers") from error
    if shape is not None and array.shape != shape:
        raise ParameterError(f"{name} = {values!r}: expected shape {shape}")
    return array


def _together(**named: np.ndarray) -> tuple[np.ndarray, ...]:
    """The arrays in their common shape."""
    try:
        return tuple(np.broadcast_arrays(*named.values()))
    except ValueError as error:
        shapes = ", ".join(f"{name} of shape {array.shape}" for name, array in named.items())
        raise ParameterError(f"{shapes}: expected shapes that broadcast") from error


def back_driven_efficiency(efficiency: ArrayLike) -> np.ndarray:
    """Efficiency when driven back, 2 - 1/efficiency, of a reducer that loses the same power in both directions. At 0 or
    less the reducer locks. Raises ParameterError for an `efficiency` outside (0, 1]. Source: S1 eq. 10."""
    driving = _floats("efficiency", efficiency)
    if not np.all((driving > 0.0) & (driving <= 1.0)):
        raise ParameterError(f"efficiency = {driving.tolist()}: expected values in (0, 1]")
    return 2.0 - 1.0 / driving


@dataclass(frozen=True, kw_only=True)
class Reducer:
    """A reducer of `ratio` (input turns a turn of the output) on a driven pulley. `efficiency` in (0.5, 1] while it
    drives its load; `driven_back` the same while the load drives it, by default S1 eq. 10. `allow_self_locking` admits
    reducers that the load cannot drive back. Raises ParameterError. Source: S1 eqs 9, 10."""

    efficiency: float
    ratio: float = 1.0
    driven_back: float | None = None
    allow_self_locking: bool = False

    def __post_init__(self) -> None:
        for name in ("efficiency", "ratio") + (() if self.driven_back is None else ("driven_back",)):
            _floats(name, getattr(self, name), shape=())
        lowest = 0.0 if self.allow_self_locking else 0.5
        if not lowest < self.efficiency <= 1.0:
            hint = "" if self.allow_self_locking else "; at 0.5 and below it locks itself: allow_self_locking=True"
            raise ParameterError(f"efficiency = {self.efficiency}: expected a value in ({lowest}, 1]{hint}")
        if not (np.isfinite(self.ratio) and self.ratio > 0):
            raise ParameterError(f"ratio = {self.ratio}: expected a positive number")
        if self.driven_back is not None and self.efficiency == 1.0 and self.driven_back != 1.0:
            raise ParameterError(f"driven_back = {self.driven_back}: expected 1 where nothing is lost while driving")
        if not self.allow_self_locking and not 0.0 < self.back_driven <= 1.0:
            raise ParameterError(f"driven_back = {self.driven_back}: expected a value in (0, 1]")
        if not -np.inf < self.back_driven <= 1.0:
            raise ParameterError(f"driven_back = {self.driven_back}: expected a finite value of at most 1")

    @property
    def back_driven(self) -> float:
        """Efficiency while the load drives it, 1."""
        return float(back_driven_efficiency(self.efficiency)) if self.driven_back is None else self.driven_back

    @property
    def loss(self) -> float:
        """Torque lost per torque given to the output while driving, 1: `efficiency_loss` of the law."""
        return 1.0 / self.efficiency - 1.0

    @property
    def back_driven_loss(self) -> float:
        """Loss while driven back over that while driving, 1: `back_driven_loss` of the law."""
        return 1.0 if self.loss == 0.0 else (1.0 - self.back_driven) / self.loss

    def output_torque(self, input_torque: ArrayLike, velocity: ArrayLike) -> np.ndarray:
        """Torque given to the output, N·m, from that at the input, N·m, at the output's velocity, rad/s; arrays
        broadcast. Raises NumericalError where it locks itself. Source: S1 eq. 9."""
        return self._alone(input_torque, velocity, to_motors=False)

    def input_torque(self, output_torque: ArrayLike, velocity: ArrayLike) -> np.ndarray:
        """Torque needed at the input, N·m, to give that to the output, N·m. Source: S1 eq. 9 solved for M_in."""
        return self._alone(output_torque, velocity, to_motors=True)

    def _alone(self, torque: ArrayLike, velocity: ArrayLike, *, to_motors: bool) -> np.ndarray:
        m, n = _together(torque=_floats("torque", torque), velocity=_floats("velocity", velocity))
        one = TendonTransmission(radius=np.array([[self.ratio]]), motor_radius=np.ones(1), reducers=[self])
        run = one.statics.inverse if to_motors else one.statics.direct
        return run(m[..., None], n[..., None], model="ideal").torque[..., 0]


@dataclass(frozen=True, kw_only=True)
class BranchLosses:
    """Tension lost on each branch:  (constant + tension |T|) sgn(S') + viscous S',  T before the loss  (S1 eqs 11, 12).

    Arrays (n, n); [i, j]: transmission i on link j ≤ i, link 0 the base. `constant` N, `tension` 1 in [0, 1), `viscous`
    N·s/m. Losses on the pulleys of the last link count on link i."""

    constant: np.ndarray
    tension: np.ndarray
    viscous: np.ndarray

    def __post_init__(self) -> None:
        for name in ("constant", "tension", "viscous"):
            values = _floats(f"{name} loss", getattr(self, name))
            if values.ndim != 2 or values.shape[0] != values.shape[1]:
                raise ParameterError(f"{name} loss of shape {values.shape}: expected (n, n), one row per transmission")
            bound = 1.0 if name == "tension" else np.inf
            used = values[np.tril_indices(len(values))]
            if not np.all((used >= 0) & (used < bound)):
                raise ParameterError(f"{name} loss = {values.tolist()}: expected values in [0, {bound})")
            object.__setattr__(self, name, np.tril(values))
        shapes = {name: getattr(self, name).shape for name in ("constant", "tension", "viscous")}
        if len(set(shapes.values())) > 1:
            raise ParameterError(f"losses of shapes {shapes}: expected one shape (n, n)")

    @classmethod
    def none(cls, num_joints: int) -> BranchLosses:
        """No losses."""
        return cls(**dict.fromkeys(("constant", "tension", "viscous"), np.zeros((num_joints, num_joints))))

    def scaled(self, *, constant: float = 1.0, tension: float = 1.0, viscous: float = 1.0) -> BranchLosses:
        """The same losses, each kind times a factor."""
        return BranchLosses(
            constant=constant * self.constant, tension=tension * self.tension, viscous=viscous * self.viscous
        )


NO_LOSSES = BranchLosses.none(0)


@dataclass(frozen=True, kw_only=True)
class Propagation:
    """Statics at each sample. `torque` (…, n), N·m: the answer, of the motors or on the joints. `tension`
    (…, n, n + 1), N: [i, 0] at motor i, [i, j] at joint j (counted from 1). `own` (…, n), N·m: torque of each
    transmission on its own joint. `branch_velocity` (…, n, n), m/s. Entries without a branch are 0."""

    torque: np.ndarray
    tension: np.ndarray
    own: np.ndarray
    branch_velocity: np.ndarray

    @property
    def loss(self) -> np.ndarray:
        """Tension lost on each branch (…, n, n), N. Source: S1 eq. 6."""
        return np.asarray(np.tril(self.tension[..., :-1] - self.tension[..., 1:]))

    @property
    def branch_power(self) -> np.ndarray:
        """Power lost on all branches (…,), W."""
        return np.asarray(np.sum(self.loss * self.branch_velocity, axis=(-2, -1)))


@dataclass(frozen=True)
class Kinematics:
    """Motion from motors to joints and back; angles rad or velocities rad/s alike, arrays (…, n)."""

    of: TendonTransmission

    def motor_to_joint(self, motor: ArrayLike) -> np.ndarray:
        """Motion of the joints (…, n) from that of the motors, by forward substitution. Source: S1 eqs 1, 2."""
        return self.of._rows(self.of.core.joint_motion, motor)

    def joint_to_motor(self, joint: ArrayLike) -> np.ndarray:
        """Motion of the motors (…, n) from that of the joints. Source: S1 eqs 1, 2."""
        return np.asarray(self.branches(joint)[..., 0] / self.of.motor_radius)

    def branches(self, joint: ArrayLike) -> np.ndarray:
        """Displacements, m, or velocities, m/s, of branches (…, n, n) from motion of the joints. Source: S1 eq. 2."""
        return self.of._rows(self.of.core.branch_motion, joint)


@dataclass(frozen=True)
class Statics:
    """Torques and tensions. Models of the losses: "ideal" none, "eq11" in proportion to tension and speed, "eq12"
    constant and viscous, "full" all three; reducers lose in each. `sign_velocity`: above 0 the sign of a branch's
    velocity is tanh(S'/sign_velocity), m/s, else it is sharp, 0 at rest."""

    of: TendonTransmission

    def inverse(
        self, joint_torque: ArrayLike, joint_velocity: ArrayLike, *, model: Model = "full", sign_velocity: float = 0.0
    ) -> Propagation:
        """Motor torques that give `joint_torque`, N·m, at `joint_velocity`, rad/s; arrays (…, n) broadcast.
        Source: S1 eqs 4, 6, 9, 11, 12 and fig. 4."""
        return self.of._statics(joint_torque, joint_velocity, model, sign_velocity, to_motors=True)

    def direct(
        self, motor_torque: ArrayLike, joint_velocity: ArrayLike, *, model: Model = "full", sign_velocity: float = 0.0
    ) -> Propagation:
        """Joint torques that `motor_torque`, N·m, gives: the exact inverse of `inverse`. Raises NumericalError where a
        reducer locks itself."""
        return self.of._statics(motor_torque, joint_velocity, model, sign_velocity, to_motors=False)


@dataclass(frozen=True, kw_only=True, eq=False)
class TendonTransmission:
    """n coupled tendon transmissions.

    `radius` (n, n), m: signed, lower triangular; [i, j]: of transmission i at joint j, positive where a positive joint
    angle takes up its cable; the diagonal is pulley radius times reducer ratio, not 0. `motor_radius` (n,), m. `losses`
    of the branches; `reducers` on the driven pulleys and `motor_reducers` at the motors (`motor_radius` contains
    their ratio), None where there is none. `at_rest`: which of its values the set-valued law of a reducer takes at
    rest. Raises ParameterError. Source: S1 secs II, III."""

    radius: np.ndarray
    motor_radius: np.ndarray
    losses: BranchLosses = NO_LOSSES
    reducers: Sequence[Reducer | None] = ()
    motor_reducers: Sequence[Reducer | None] = ()
    at_rest: AtRest = "drive"
    kinematics: Kinematics = field(init=False, repr=False, compare=False)
    statics: Statics = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        radius, motor = np.asarray(self.radius, dtype=float), np.asarray(self.motor_radius, dtype=float)
        n = motor.size
        if motor.ndim != 1 or n < 1 or not np.all(np.isfinite(motor) & (motor != 0)):
            raise ParameterError(f"motor_radius = {motor.tolist()}: expected a list of lengths other than 0, m")
        if radius.shape != (n, n) or not np.all(np.isfinite(radius)) or np.any(np.triu(radius, 1) != 0):
            raise ParameterError(
                f"radius = {radius.tolist()}: expected a lower triangular array of shape ({n}, {n}), m"
            )
        if np.any(np.diag(radius) == 0):
            raise ParameterError(f"radius = {radius.tolist()}: expected no 0 on the diagonal, the driven pulleys")
        losses = BranchLosses.none(n) if self.losses is NO_LOSSES else self.losses
        if len(losses.constant) != n:
            raise ParameterError(f"losses of {len(losses.constant)} transmissions: expected {n}, one per motor radius")
        made: dict[str, Any] = {"radius": radius, "motor_radius": motor, "losses": losses}
        for name in ("reducers", "motor_reducers"):
            given = getattr(self, name)
            given = tuple(given) if isinstance(given, Iterable) else given
            if not (isinstance(given, tuple) and all(r is None or isinstance(r, Reducer) for r in given)):
                raise ParameterError(f"{name} = {given!r}: expected a Reducer or None for each joint")
            made[name] = given or (None,) * n
            if len(made[name]) != n:
                raise ParameterError(f"{name}: {len(made[name])} given, expected {n}, None where there is none")
        made |= {"kinematics": Kinematics(self), "statics": Statics(self)}
        for name, value in made.items():
            object.__setattr__(self, name, value)

    @property
    def num_joints(self) -> int:
        """Number of joints, and of motors."""
        return len(self.motor_radius)

    @property
    def coupling(self) -> np.ndarray:
        """K (n, n), 1: [k, j] = radius of transmission k over that of the own one at joint j. Source: S1 eq. 5."""
        return np.asarray(self.radius / np.diag(self.radius))

    @cached_property
    def core(self) -> _core.TendonRouting:
        """The compiled recursion, with these numbers in it."""
        return _core.TendonRouting(
            radius=self.radius, motor_radius=self.motor_radius.tolist(),
            constant_loss=self.losses.constant, tension_loss=self.losses.tension, viscous_loss=self.losses.viscous,
            reducers=_losses_of(self.reducers), motor_reducers=_losses_of(self.motor_reducers), at_rest=self.at_rest,
        )  # fmt: skip

    def parameters(self) -> dict[str, float]:
        """Parameters of the system `tendon_routing` with these numbers in it, SI; joints that are not there have unit
        radii and no losses. Raises ParameterError for more than four joints and for reducers that the system lacks."""
        n = self.num_joints
        if n > LARGEST_SYSTEM or any(self.motor_reducers):
            raise ParameterError(f"{n} joints, reducers at motors {self.motor_reducers}: expected at most 4 and none")
        for k, fitted in enumerate(self.reducers):
            if fitted is None:
                continue
            if not np.isclose(fitted.back_driven, back_driven_efficiency(fitted.efficiency), rtol=0.0, atol=1e-12):
                raise ParameterError(
                    f"reducers[{k}].driven_back = {fitted.driven_back}: expected None, S1 eq. 10, which is all that "
                    "tendon_routing has"
                )
            if self.at_rest != "drive":
                raise ParameterError(
                    f"at_rest = {self.at_rest!r}: expected 'drive', which is all that tendon_routing has"
                )
        values: dict[str, float] = {}
        for i in range(LARGEST_SYSTEM):
            own = i < n
            reducer = self.reducers[i] if own else None
            ratio = 1.0 if reducer is None else reducer.ratio
            values[f"motor_radius_{i + 1}"] = float(self.motor_radius[i]) if own else 1.0
            values[f"reducer_ratio_{i + 1}"] = float(ratio)
            values[f"reducer_efficiency_{i + 1}"] = 1.0 if reducer is None else float(reducer.efficiency)
            for j in range(i + 1):
                radius = float(self.radius[i, j]) if own else float(i == j)
                values[f"radius_{i + 1}_{j + 1}"] = radius / ratio if i == j else radius
                for kind in ("constant", "tension", "viscous"):
                    values[f"{kind}_loss_{i + 1}_{j}"] = float(getattr(self.losses, kind)[i, j]) if own else 0.0
        return values

    def _rows(self, apply: Any, motion: ArrayLike) -> np.ndarray:
        values = self._matching("motion", motion)
        rows = apply(values.reshape(-1, self.num_joints))
        return np.asarray(rows).reshape(*values.shape[:-1], *rows.shape[1:])

    def _matching(self, name: str, values: ArrayLike) -> np.ndarray:
        array = _floats(name, values)
        if array.ndim < 1 or array.shape[-1] != self.num_joints:
            raise ParameterError(f"{name} of shape {array.shape}: expected (…, {self.num_joints}), joint by joint")
        if not np.all(np.isfinite(array)):
            raise ParameterError(f"{name} = {array[~np.isfinite(array)][0]}: expected finite numbers")
        return array

    def _statics(
        self, torque: ArrayLike, velocity: ArrayLike, model: str, sign_velocity: float, *, to_motors: bool
    ) -> Propagation:
        torque, velocity = self._matching("torque", torque), self._matching("joint_velocity", velocity)
        torque, velocity = _together(torque=torque, joint_velocity=velocity)
        if not 0.0 <= _floats("sign_velocity", sign_velocity, shape=()) < np.inf:
            raise ParameterError(f"sign_velocity = {sign_velocity}: expected a finite speed of at least 0, m/s")
        if model not in LOSSES:
            raise ParameterError(f'model = "{model}": expected ideal, eq11, eq12 or full')
        lead, n = torque.shape[:-1], self.num_joints
        statics = self.core.statics(
            torque=torque.reshape(-1, n), joint_velocity=velocity.reshape(-1, n), losses=LOSSES[model],
            sign_velocity=sign_velocity, to_motors=to_motors,
        )  # fmt: skip
        shaped = {name: np.asarray(a).reshape(*lead, *a.shape[1:]) for name, a in statics.items()}
        return Propagation(
            torque=shaped["torque"], tension=shaped["tension"], own=shaped["own"], branch_velocity=shaped["velocity"]
        )


def _losses_of(reducers: Sequence[Reducer | None]) -> tuple[list[float], list[float]]:
    loss = [0.0 if r is None else r.loss for r in reducers]
    return loss, [1.0 if r is None else r.back_driven_loss for r in reducers]
