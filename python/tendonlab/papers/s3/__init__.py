"""S3: torque transmission of a pair of tendons in sheaths (Bowden cables) under pretension, in the paper's notation.

Shape of the sheaths and statics (`TransmissionCoefficients`), the forward model with its memory at low speed
(`predict`), both identifications (`fit_nelder_mead`, `fit_gradient`), and an independent twin of the rig (`Chain`) with
the paper's data set (`generate_dataset`). The simulator of the library is the system "bowden_pair".

The paper prints no raw data and leaves out radii, length, gains and the unit of velocity: what is assumed for them is
in the tables `S3_setup` and `S3_shapes`, and every number from the twin is reconstructed, not measured."""

from tendonlab.papers.s3.chain import TORQUE_NOISE_SD, VELOCITY_NOISE_SD, Chain
from tendonlab.papers.s3.compiled import bowden_pair
from tendonlab.papers.s3.diagnosis import Withheld, identified, withheld
from tendonlab.papers.s3.fit import Fit, Objective, fit_gradient, fit_nelder_mead, profile, weakness
from tendonlab.papers.s3.groups import Record, generate_dataset, law_record, run_chain, to_dataset
from tendonlab.papers.s3.model import GATE_PERIOD, Prediction, mean_squared_error, predict, predict_log
from tendonlab.papers.s3.rig import (
    FrictionParameters,
    Rig,
    assumed_rig,
    cable_pretension,
    free_body,
    paper_parameters,
)
from tendonlab.papers.s3.shapes import BumpShape, paper_shape, paper_shapes
from tendonlab.papers.s3.sliding import Sliding, sliding_regression
from tendonlab.papers.s3.statics import TransmissionCoefficients, capstan_tension
from tendonlab.papers.s3.trajectories import Trajectory, table_1
from tendonlab.procedures.sheath_shape import Shape

__all__ = [
    "GATE_PERIOD",
    "TORQUE_NOISE_SD",
    "VELOCITY_NOISE_SD",
    "BumpShape",
    "Chain",
    "Fit",
    "FrictionParameters",
    "Objective",
    "Prediction",
    "Record",
    "Rig",
    "Shape",
    "Sliding",
    "Trajectory",
    "TransmissionCoefficients",
    "Withheld",
    "assumed_rig",
    "bowden_pair",
    "cable_pretension",
    "capstan_tension",
    "fit_gradient",
    "fit_nelder_mead",
    "free_body",
    "generate_dataset",
    "identified",
    "law_record",
    "mean_squared_error",
    "paper_parameters",
    "paper_shape",
    "paper_shapes",
    "predict",
    "predict_log",
    "profile",
    "run_chain",
    "sliding_regression",
    "table_1",
    "to_dataset",
    "weakness",
    "withheld",
]
