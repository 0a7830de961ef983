"""Writes tests/golden/stick_slip.csv: a slowly dragged joint that sticks and slips, by a fixed step of 1 microsecond.

Shares nothing with the library: its own C text, the classical Runge-Kutta method of order 4, modes looked at once a
step (what reverses within a step is put to rest, what is pushed beyond its level slides from the next step on), so
that an event is late by at most a step.
Run: python reference_stick_slip.py; needs a C compiler; takes about ten seconds."""

import ctypes
import subprocess
import tempfile
from datetime import date
from pathlib import Path

import numpy as np

GOLDEN = Path(__file__).resolve().parents[1] / "golden" / "stick_slip.csv"
PARAMETERS = {
    "motor_inertia": 1.2e-4,
    "joint_inertia": 0.02,
    "gear_ratio": 10.0,
    "cable_stiffness": 5.0,
    "cable_damping": 0.02,
    "motor_viscous": 2e-4,
    "motor_coulomb": 3e-3,
    "joint_viscous": 0.02,
    "joint_coulomb": 0.12,
    "joint_static_excess": 0.06,
    "joint_stribeck_velocity": 0.05,
}
LOOP = {"proportional": 0.5, "derivative": 0.01}
DRAG = 0.8  # rad/s, of the motor's reference
END, SPACING = 14.0, 0.02

TEXT = r"""
#include <math.h>
typedef struct { double jm, jl, n, k, c, bm, fm, bl, fl, fe, vs, kp, kd, drag; } P;
static double cable(const P* p, const double* y) { return p->k * (y[0] / p->n - y[2]) + p->c * (y[1] / p->n - y[3]); }
static double level(const P* p, double w) { return p->fl + p->fe * exp(-(w / p->vs) * (w / p->vs)); }
/* what acts on motor and joint besides dry friction */
static void push(const P* p, double t, const double* y, double* f) {
  const double u = p->kp * (p->drag * t - y[0]) + p->kd * (p->drag - y[1]), s = cable(p, y);
  f[0] = u - p->bm * y[1] - s / p->n;
  f[1] = s - p->bl * y[3];
}
static void rate(const P* p, double t, const double* y, const int* way, double* r) {
  double f[2];
  push(p, t, y, f);
  r[0] = y[1], r[2] = y[3];
  r[1] = way[0] ? (f[0] - way[0] * p->fm) / p->jm : 0;
  r[3] = way[1] ? (f[1] - way[1] * level(p, y[3])) / p->jl : 0;
}
void drag(const P* p, double h, long steps, long every, double* out) {
  double y[4] = {0, 0, 0, 0};
  int way[2] = {0, 0};
  for (long i = 0; i <= steps; ++i) {
    const double t = i * h;
    if (i % every == 0) {
      double* o = out + 3 * (i / every);
      o[0] = y[0], o[1] = y[2], o[2] = cable(p, y);
    }
    double f[2];
    push(p, t, y, f);
    for (int j = 0; j < 2; ++j) {
      const double hold = j ? level(p, 0) : p->fm;
      if (!way[j] && fabs(f[j]) > hold) way[j] = f[j] > 0 ? 1 : -1;
    }
    double k[4][4], z[4];
    rate(p, t, y, way, k[0]);
    for (int s = 1; s < 4; ++s) {
      const double a = s == 3 ? h : 0.5 * h;
      for (int j = 0; j < 4; ++j) z[j] = y[j] + a * k[s - 1][j];
      rate(p, t + a, z, way, k[s]);
    }
    for (int j = 0; j < 4; ++j) y[j] += h / 6 * (k[0][j] + 2 * k[1][j] + 2 * k[2][j] + k[3][j]);
    for (int j = 0; j < 2; ++j)
      if (way[j] && way[j] * y[2 * j + 1] < 0) y[2 * j + 1] = 0, way[j] = 0;
  }
}
"""


def dragged(step: float) -> np.ndarray:
    """Motor angle, joint angle and cable torque, (samples, 3), by steps of `step`, s."""
    with tempfile.TemporaryDirectory() as folder:
        source, library = Path(folder) / "drag.c", Path(folder) / "drag.so"
        source.write_text(TEXT)
        subprocess.run(["cc", "-O2", "-shared", "-fPIC", "-o", library, source, "-lm"], check=True)
        run = ctypes.CDLL(str(library)).drag
    values = np.array([*PARAMETERS.values(), *LOOP.values(), DRAG])
    every = round(SPACING / step)
    out = np.zeros((round(END / SPACING) + 1, 3))
    pointer = ctypes.POINTER(ctypes.c_double)
    steps = ctypes.c_long(every * (len(out) - 1))
    run(values.ctypes.data_as(pointer), ctypes.c_double(step), steps, ctypes.c_long(every), out.ctypes.data_as(pointer))
    return out


def main() -> None:
    fine, coarse = dragged(1e-6), dragged(2e-6)
    change = np.sqrt(np.mean((fine - coarse) ** 2, axis=0) / np.mean(fine**2, axis=0))
    table = np.column_stack([np.arange(len(fine)) * SPACING, fine])
    head = [
        f"written by tests/integrate/reference_stick_slip.py on {date.today()}; Runge-Kutta 4, fixed step 1e-6 s",
        f"relative rms change against a step of 2e-6 s: {', '.join(f'{c:.1e}' for c in change)}",
        "t (s),motor_angle (rad),joint_angle (rad),cable_torque (N*m)",
    ]
    np.savetxt(GOLDEN, table, fmt=["%.2f", "%.10g", "%.10g", "%.10g"], delimiter=",", header="\n".join(head))
    slips = np.count_nonzero((np.diff(fine[1:, 1]) > 0) & (np.diff(fine[:-1, 1]) == 0))
    print("\n".join(head), f"{slips} slips", sep="\n")


if __name__ == "__main__":
    main()
