"""Both identifications of S3's five numbers side by side: the paper's Nelder–Mead, and exact derivatives.

The gate with its fitted steepness is a step: where a sample lies on one side of the threshold or the other does not
change with a small change of it, so the objective is flat or jumps. A search from one start ends near it; derivatives
need a soft gate first, which is then made steeper in stages, and several starts of the threshold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd
from scipy.optimize import least_squares, minimize

from tendonlab.arguments import whole
from tendonlab.errors import ParameterError
from tendonlab.papers.s3.compiled import NAMES, CompiledRecord
from tendonlab.papers.s3.groups import Record
from tendonlab.papers.s3.rig import DEGREE, VELOCITY_UNITS, FrictionParameters, paper_parameters

WEAK_CHANGE, WEAK_RISE = 0.2, 0.05  # a parameter is weak if this change of it raises the error by less than this share


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit:
    """What an identification found: `p`, its mean squared error `mse`, (N·m)², and every start or stage in `path`."""

    p: FrictionParameters
    mse: float
    path: pd.DataFrame = field(repr=False)


class Objective:
    """The paper's objective: mean squared error over all samples of all records, (N·m)²; sheaths count as bent the same
    from both ends."""

    def __init__(self, records: Sequence[Record]) -> None:
        whole("number of records", len(records), 1)
        self.compiled = [CompiledRecord.of(record) for record in records]

    def residual(self, p: FrictionParameters) -> np.ndarray:
        """Predicted less measured output torque, N·m, of all records one after the other."""
        return np.concatenate([one.run(p)[0] for one in self.compiled])

    def slopes(self, p: FrictionParameters) -> np.ndarray:
        """Derivatives of that by mu_d, mu_s, v_s, v_thres and s_v in the unit of `p`, (n, 5)."""
        return np.concatenate([one.run(p, NAMES)[1] for one in self.compiled])

    def __call__(self, p: FrictionParameters) -> float:
        return float(np.mean(self.residual(p) ** 2))


def fit_nelder_mead(
    records: Sequence[Record],
    *,
    start: FrictionParameters | None = None,
    num_starts: int = 4,
    spread: float = 0.7,
    max_iterations: int = 400,
    seed: int | np.random.Generator = 0,
) -> Fit:
    """The paper's way, from several starts: the simplex of Nelder and Mead on the logarithms of all five numbers.

    The first start is `start` (the paper's p), the others are spread about it by a normal factor of sd `spread` in log,
    the last of them with a gate as soft as 5/v_thres². `path` has one row per start: its first and its last point."""
    objective, rng = Objective(records), np.random.default_rng(seed)
    first = paper_parameters() if start is None else start
    rows: list[dict[str, float]] = []
    best: tuple[float, FrictionParameters] | None = None
    for k in range(num_starts):
        x = _logs(first) + (rng.normal(0.0, spread, len(NAMES)) if k else 0.0)
        if k == num_starts - 1 and k:
            x[NAMES.index("s_v")] = np.log(5.0) - 2.0 * x[NAMES.index("v_thres")]
        found = minimize(
            lambda x: objective(_from_logs(x, first)), x, method="Nelder-Mead",
            options={"maxiter": max_iterations, "xatol": 1e-4, "fatol": 1e-7},
        )  # fmt: skip
        p = _from_logs(found.x, first)
        rows.append({"mse": float(found.fun), **{n: getattr(p, n) for n in NAMES}, "evaluations": float(found.nfev)})
        if best is None or found.fun < best[0]:
            best = (float(found.fun), p)
    if best is None:
        raise ParameterError(f"num_starts = {num_starts}: expected at least 1")
    return Fit(p=best[1], mse=best[0], path=pd.DataFrame(rows).rename_axis("start"))


def fit_gradient(
    records: Sequence[Record],
    *,
    start: FrictionParameters | None = None,
    free: Sequence[str] = NAMES[:4],
    num_starts: int = 5,
    softest: float = 5.0,
    steepest: float = 1000.0,
    factor: float = 3.0,
    polish: bool = True,
) -> Fit:
    """Least squares with exact derivatives through the recursion of S3 eq. 21, on bounded logarithms, while the gate
    hardens; the best of several starts.

    `free`: which of mu_d, mu_s, v_s, v_thres move; mu_s keeps its ratio to mu_d where it is not free. The first start
    is `start` (the paper's p); the others move its threshold and its Stribeck velocity, by which the error has many
    minima, over the speeds of the records. The gate's steepness s_v v_thres² grows from `softest` by `factor` per stage
    up to `steepest`. The last gate is a step; `polish` then searches the free numbers of the best start without
    derivatives. `path` has every stage of every start. Raises ParameterError for an unknown name in `free`."""
    unknown = [name for name in free if name not in NAMES[:4]]
    if unknown or not free:
        raise ParameterError(f"free = {tuple(free)}: expected some of {', '.join(NAMES[:4])}")
    whole("num_starts", num_starts, 1)
    objective, first = Objective(records), paper_parameters() if start is None else start
    fastest = _fastest(records, first)
    search = _Search(objective, tuple(free), _bounds(fastest))
    steepnesses = [softest]
    while steepnesses[-1] < steepest:
        steepnesses.append(min(steepnesses[-1] * factor, steepest))
    rows: list[dict[str, float]] = []
    ends = []
    for k, p in enumerate(_starts(first, fastest, num_starts)):
        for steepness in steepnesses:
            p = search.stage(replace(p, s_v=steepness / p.v_thres**2))
            rows.append(_row(objective, p, start=k, steepness=steepness))
        ends.append((rows[-1]["mse"], k, p))
    _, k, p = min(ends, key=lambda end: end[:2])
    if polish:
        p = search.polished(p)
        rows.append(_row(objective, p, start=k, steepness=steepnesses[-1]))
    return Fit(p=p, mse=objective(p), path=pd.DataFrame(rows).rename_axis("stage"))


def _starts(first: FrictionParameters, fastest: float, num: int) -> list[FrictionParameters]:
    """The first start, and others whose thresholds lie among the speeds of the records, below the Stribeck velocity."""
    thresholds = [float(share * fastest) for share in np.geomspace(0.02, 0.3, num - 1)]
    return [first, *(replace(first, v_thres=v, v_s=3.0 * v) for v in thresholds)]


def _row(objective: Objective, p: FrictionParameters, *, start: int, steepness: float) -> dict[str, float]:
    return {"start": start, "steepness": steepness, "mse": objective(p), **{n: getattr(p, n) for n in NAMES}}


def weakness(records: Sequence[Record], p: FrictionParameters) -> pd.DataFrame:
    """How much each number matters: rise of the mean squared error, (N·m)², where it is 20 % smaller and larger, and
    whether the data identify it (both rises above 5 % of the error itself)."""
    objective = Objective(records)
    base = objective(p)
    rows = {}
    for name in NAMES:
        value = getattr(p, name)
        less, more = (objective(p.with_values({name: value * f})) - base for f in (0.8, 1.2))
        rows[name] = {
            "value": value,
            "rise_less": less,
            "rise_more": more,
            "identified": min(less, more) > WEAK_RISE * base,
        }
    return pd.DataFrame(rows).T.astype({"value": float, "rise_less": float, "rise_more": float, "identified": bool})


def profile(records: Sequence[Record], p: FrictionParameters, name: str, values: Sequence[float]) -> pd.Series:
    """Mean squared error, (N·m)², over `values` of one number, the others held: n times it over the noise's variance is
    twice the negative log-likelihood."""
    if name not in NAMES:
        raise ParameterError(f"name = {name!r}: expected one of {', '.join(NAMES)}")
    objective = Objective(records)
    errors = [objective(p.with_values({name: float(value)})) for value in values]
    return pd.Series(errors, index=pd.Index(list(values), name=name), name="mse")


def _fastest(records: Sequence[Record], like: FrictionParameters) -> float:
    """The largest speed of the records, in the unit of `like`."""
    return max(float(record.log["v"].abs().max()) for record in records) * DEGREE / VELOCITY_UNITS[like.velocity_unit]


def _bounds(fastest: float) -> dict[str, tuple[float, float]]:
    """Bounds of the free numbers: beyond them the law no longer changes, and its numbers underflow."""
    coefficient = (1e-4, 1.0)
    return {
        "mu_d": coefficient, "mu_s": coefficient, "v_s": (1e-3 * fastest, 10.0 * fastest),
        "v_thres": (1e-3 * fastest, fastest),
    }  # fmt: skip


@dataclass(frozen=True)
class _Search:
    """A search over the logarithms of the numbers `free`, within bounds by name."""

    objective: Objective
    free: tuple[str, ...]
    bounds: dict[str, tuple[float, float]]

    def moved(self, p: FrictionParameters, x: np.ndarray) -> FrictionParameters:
        """`p` with its free numbers at exp(x): s_v follows v_thres, and mu_s follows mu_d unless it is free."""
        moved = p.with_values({name: float(np.exp(v)) for name, v in zip(self.free, x, strict=True)})
        if "mu_s" not in self.free:
            moved = replace(moved, mu_s=moved.mu_d * p.mu_s / p.mu_d)
        return replace(moved, s_v=p.s_v * (p.v_thres / moved.v_thres) ** 2)

    def stage(self, p: FrictionParameters) -> FrictionParameters:
        """The fit at one steepness of the gate."""
        low, high = np.log([self.bounds[name] for name in self.free]).T
        inside = 1e-6 * (high - low)
        found = least_squares(
            lambda x: self.objective.residual(self.moved(p, x)), np.clip(self._logs(p), low + inside, high - inside),
            jac=lambda x: self._slopes(self.moved(p, x)), bounds=(low, high), x_scale=0.1, max_nfev=30,
        )  # fmt: skip
        return self.moved(p, found.x)

    def polished(self, p: FrictionParameters) -> FrictionParameters:
        """The best near `p` without derivatives: a scan of the threshold within 10 %, since the error jumps wherever a
        sample changes sides, then a simplex of 1 % of each free number."""
        if "v_thres" in self.free:
            alone = replace(self, free=("v_thres",))
            factors = np.linspace(0.9, 1.1, 61)
            nearby = [replace(alone.moved(p, np.log([p.v_thres * f])), mu_s=p.mu_s) for f in factors]
            p = min([p, *nearby], key=self.objective)
        x = self._logs(p)
        simplex = np.vstack([x, x + 0.01 * np.eye(len(x))])
        options = {"maxiter": 100, "xatol": 1e-4, "fatol": 1e-9, "initial_simplex": simplex}
        found = minimize(lambda x: self.objective(self.moved(p, x)), x, method="Nelder-Mead", options=options)
        return min([p, self.moved(p, found.x)], key=self.objective)

    def _logs(self, p: FrictionParameters) -> np.ndarray:
        return np.log([getattr(p, name) for name in self.free])

    def _slopes(self, p: FrictionParameters) -> np.ndarray:
        """Derivatives of the residual at `p` by the logarithms of the free numbers."""
        by = dict(zip(NAMES, self.objective.slopes(p).T, strict=True))
        columns = {name: by[name] * getattr(p, name) for name in self.free}
        if "v_thres" in self.free:
            columns["v_thres"] = columns["v_thres"] - 2.0 * p.s_v * by["s_v"]
        if "mu_d" in self.free and "mu_s" not in self.free:
            columns["mu_d"] = columns["mu_d"] + p.mu_s * by["mu_s"]
        return np.column_stack(list(columns.values()))


def _logs(p: FrictionParameters) -> np.ndarray:
    return np.log([getattr(p, name) for name in NAMES])


def _from_logs(x: np.ndarray, like: FrictionParameters) -> FrictionParameters:
    values = np.exp(np.clip(x, -30.0, 30.0))  # a simplex may wander; beyond this the law no longer changes
    return like.with_values({name: float(v) for name, v in zip(NAMES, values, strict=True)})
