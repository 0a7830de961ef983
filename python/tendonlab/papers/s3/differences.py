"""Printed numbers of S3 and results of a separate computation on its twin, next to results of this library."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import pandas as pd

from tendonlab.papers.s3.fit import Fit
from tendonlab.papers.s3.groups import Record
from tendonlab.papers.s3.rig import assumed_rig, cable_pretension, paper_parameters
from tendonlab.papers.s3.shapes import paper_shapes
from tendonlab.papers.s3.sliding import sliding_regression
from tendonlab.papers.s3.statics import TransmissionCoefficients
from tendonlab.papers.s3.trajectories import table_1
from tendonlab.papers.tables import table

Row = tuple[str, str, float, float, float]  # quantity, where from, printed, computed, tolerance (absolute)


def differences(fit: Fit, recovered: Fit, records: Mapping[int, Record]) -> pd.DataFrame:
    """One row per number: printed, computed, difference, tolerance, and whether the difference is within.

    `fit`: of the twin's theta_6. `recovered`: of data that obey the paper's law exactly. `records`: sines of the twin
    at 54 kg by shape number, with 2, 7 and 8."""
    rows = [*_tables(), *_shapes(), *_recovery(recovered), *_twin(fit, records)]
    frame = pd.DataFrame(rows, columns=["quantity", "source", "printed", "computed", "tolerance"])
    frame.insert(4, "difference", frame["computed"] - frame["printed"])
    return frame.assign(within=frame["difference"].abs() <= frame["tolerance"]).set_index("quantity")


def _tables() -> Iterator[Row]:
    for row in table("S3_fig5b_pretension").to_dict("records"):
        reading, printed = float(row["load_cell_kg"]), float(row["T_s_per_cable_N"])
        yield f"T_s at {reading:g} kg (N)", "Fig. 5b", printed, cable_pretension(reading), 1e-7
    sines = table_1()[:3]  # the period of the superposed torque is not printed
    for printed, trajectory in zip(table("S3_table1_dataset")["frequency_hz"][:3], sines, strict=True):
        yield (
            f"frequency of a {trajectory.period:g} s sine (Hz)",
            "Table I",
            _number(printed),
            trajectory.frequency,
            1e-9,
        )


def _shapes() -> Iterator[Row]:
    for printed, shape, name in zip(
        table("S3_shapes")["assumed_wrap_angle_rad"], paper_shapes(), table("S3_shapes")["shape"], strict=True
    ):
        yield f"wrap angle of {name} (rad)", "Fig. 4, assumed family", float(printed), shape.wrap_angle, 1e-6


def _recovery(recovered: Fit) -> Iterator[Row]:
    p = paper_parameters()
    yield "mu_d from data of the law", "p in the text", p.mu_d, recovered.p.mu_d, 0.02 * p.mu_d
    yield "v_thres from data of the law (deg/s)", "p in the text", p.v_thres, recovered.p.v_thres, 0.02 * p.v_thres


def _twin(fit: Fit, records: Mapping[int, Record]) -> Iterator[Row]:
    """Own results of an earlier twin: tolerances cover seeds and solvers."""
    own, rig = table("S3_twin_results").set_index("case"), assumed_rig()
    yield "MSE of the fit on theta_6 (N²m²)", "twin", _number(own.at["fit", "mse_after_fit_on_theta6"]), fit.mse, 0.05
    for number in (2, 7, 8):
        row, record = own.loc[f"shape{number}"], records[number]
        law = TransmissionCoefficients.of(
            record.shape, mu=fit.p.mu_d, T_s=record.pretension, r_in=rig.r_in, r_out=rig.r_out
        )
        found = sliding_regression(record, v_thres=paper_parameters().v_thres)
        of, told = f"theta_{number}", "twin"
        model = _number(row["model_offset_Nm"])  # fits of other data agree on mu_d to 4 %
        yield f"offset of the fitted model, {of} (N m)", told, model, law.offset, 0.04 * abs(model)
        yield f"sliding slope of {of}", told, _number(row["sliding_slope"]), found.slope, 0.01
        yield f"sliding offset of {of} (N m)", told, _number(row["sliding_offset_Nm"]), found.offset, 0.08 * -law.offset
        yield f"MSE predicted on {of} (N²m²)", told, _number(row["mse_after_fit_on_theta6"]), record.mse(fit.p), 0.05


def _number(cell: object) -> float:
    return float(str(cell))
