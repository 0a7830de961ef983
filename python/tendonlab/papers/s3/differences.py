"""Printed numbers of S3 and results of a separate computation on its twin, next to results of this library."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import pandas as pd

from tendonlab.papers.compared import DERIVED, RECONSTRUCTED, TWIN, Number, compared
from tendonlab.papers.s3.fit import Fit
from tendonlab.papers.s3.groups import Record
from tendonlab.papers.s3.rig import assumed_rig, cable_pretension, paper_parameters
from tendonlab.papers.s3.shapes import paper_shapes
from tendonlab.papers.s3.sliding import sliding_regression
from tendonlab.papers.s3.statics import TransmissionCoefficients
from tendonlab.papers.s3.trajectories import table_1
from tendonlab.papers.tables import table


def differences(fit: Fit, recovered: Fit, records: Mapping[int, Record]) -> pd.DataFrame:
    """One row per number, as `compared` gives them.

    `fit`: of the twin's theta_6, of mu_d and v_thres alone. `recovered`: of data that obey the paper's law exactly.
    `records`: sines of the twin at 54 kg by shape number, with 2, 7 and 8."""
    return compared([*_tables(), *_shapes(), *_recovery(recovered), *_twin(fit, records)])


def _tables() -> Iterator[Number]:
    for row in table("S3_fig5b_pretension").to_dict("records"):
        reading, expected = float(row["load_cell_kg"]), float(row["T_s_per_cable_N"])
        name = f"Fig. 5b: T_s at {reading:g} kg"
        yield Number(name, "N", DERIVED, expected, cable_pretension(reading), 1e-7)
    sines = table_1()[:3]  # the period of the superposed torque is not printed
    for expected, trajectory in zip(table("S3_table1_dataset")["frequency_hz"][:3], sines, strict=True):
        name = f"Table I: frequency of a {trajectory.period:g} s sine"
        yield Number(name, "Hz", DERIVED, _number(expected), trajectory.frequency, 1e-9)


def _shapes() -> Iterator[Number]:
    for expected, shape, name in zip(
        table("S3_shapes")["assumed_wrap_angle_rad"], paper_shapes(), table("S3_shapes")["shape"], strict=True
    ):
        yield Number(f"Fig. 4: wrap angle of {name}", "rad", RECONSTRUCTED, float(expected), shape.wrap_angle, 1e-6)


def _recovery(recovered: Fit) -> Iterator[Number]:
    p = paper_parameters()
    yield Number("p: mu_d, from data of the law", "1", TWIN, p.mu_d, recovered.p.mu_d, 0.02 * p.mu_d)
    yield Number("p: v_thres, from data of the law", "deg/s", TWIN, p.v_thres, recovered.p.v_thres, 0.02 * p.v_thres)


def _twin(fit: Fit, records: Mapping[int, Record]) -> Iterator[Number]:
    """Own results of an earlier twin: tolerances cover seeds and solvers."""
    own, rig = table("S3_twin_results").set_index("case"), assumed_rig()
    expected = _number(own.at["fit", "mse_after_fit_on_theta6"])
    yield Number("MSE of the fit of two numbers on theta_6", "N²m²", TWIN, expected, fit.mse, 0.05)
    for number in (2, 7, 8):
        row, record = own.loc[f"shape{number}"], records[number]
        law = TransmissionCoefficients.of(
            record.shape, mu=fit.p.mu_d, T_s=record.pretension, r_in=rig.r_in, r_out=rig.r_out
        )
        found = sliding_regression(record, v_thres=paper_parameters().v_thres)
        model, offset = _number(row["model_offset_Nm"]), _number(row["sliding_offset_Nm"])
        of = f"theta_{number}"  # fits of other data agree on mu_d to 4 %
        yield Number(f"offset of the fitted model, {of}", "N·m", TWIN, model, law.offset, 0.04 * abs(model))
        yield Number(f"sliding slope of {of}", "1", TWIN, _number(row["sliding_slope"]), found.slope, 0.01)
        yield Number(f"sliding offset of {of}", "N·m", TWIN, offset, found.offset, 0.08 * -law.offset)
        expected = _number(row["mse_after_fit_on_theta6"])
        yield Number(f"MSE predicted on {of}", "N²m²", TWIN, expected, record.mse(fit.p), 0.05)


def _number(cell: object) -> float:
    return float(str(cell))
