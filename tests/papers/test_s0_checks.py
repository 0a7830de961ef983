"""Every number of the check file of S0, at the tolerance that stands beside it."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tendonlab import _core
from tendonlab.papers.s0 import bearings, bench, drive, fits, maps, models, twin
from tendonlab.procedures import reactive_torque, universal_threshold

FILE = Path(__file__).resolve().parents[1] / "golden" / "papers" / "S0.json"
CHECKS = json.loads(FILE.read_text(encoding="utf-8"))["checks"]
SETS = json.loads(FILE.read_text(encoding="utf-8"))["parameter_sets"]
Check = Mapping[str, Any]
CENTRED = ("C25P104GX", "C25P104GP", "C35P75GX")


def where(check: Check) -> bench.Configuration:
    """The configuration that the name of a check ends with, "….C25P104GX.D4M"."""
    *_, transmission, load = check["name"].split(".")
    return bench.loaded(transmission, load)


def curve(torque: Callable[[np.ndarray], np.ndarray], check: Check) -> dict[str, Any]:
    found = maps.features(maps.FINE, torque(maps.FINE))
    return {"T": torque(np.array(check["input"]["speeds"], float)), "features": [f.tolist() for f in found]}


def of_twin(check: Check) -> dict[str, Any]:
    of = where(check)
    assert bearings.relative_load(of) == pytest.approx(check["input"]["L_r"], rel=1e-12)
    return curve(lambda w: twin.friction(of, w), check)


def of_proposed(check: Check) -> dict[str, Any]:
    model, given = models.reconstructed(where(check).transmission), check["input"]
    return curve(lambda w: model.torque(w, load=given["L_r"], ratio=given["N"]), check)


def of_table8(check: Check) -> dict[str, Any]:
    of, given = where(check), check["input"]
    speed, load, ratio = given["speed"], given["L_r"], given["N"]
    measured = twin.measured_peak(of.transmission, of.load)
    first, second = (
        models.reconstructed(of.transmission, s).torque(speed, load=load, ratio=ratio) for s in models.PROPOSED_SETS
    )
    lugre = models.printed_lugre(of.transmission).torque(speed)
    errors = [100 * abs(float(t) - measured) / measured for t in (first, second, lugre)]
    return {
        "measured": measured,
        "proposed_table8_set": first,
        "proposed_identified_on_twin": second,
        "lugre": lugre,
        "err_pct_table8_set": errors[0],
        "err_pct_identified": errors[1],
        "err_pct_lugre": errors[2],
        "twin": twin.friction(of, speed),
    }


def of_lugre_fit(check: Check) -> dict[str, Any]:
    speed, _, torque = twin.points(check["name"].split(".")[1])
    model = fits.fit_static_lugre(speed, torque).model
    return {name: getattr(model, name) for name in check["output"]}


def of_lugre(check: Check) -> dict[str, Any]:
    g = check["input"]
    return {"T": models.Lugre(F_c=g["Fc"], F_s=g["Fs"], theta_s=g["vs"], F_v=g["Fv"], alpha=g["al"]).torque(g["w"])}


def of_relative_load(check: Check) -> dict[str, Any]:
    of = where(check)
    found: dict[str, Any] = {
        f"T_pr={t}": {
            "L_r": bearings.relative_load(of, pretension=t),
            "sum_R_l": bearings.pulley_reactions(of, pretension=t).total,
            "sum_R_w": bearings.reactions(of.pulley).total,
        }
        for t in (0, 10, 20, 100)
    }
    found["L_r_Rw_all_shafts_T0"] = bearings.relative_load(of, scope="transmission")
    found["L_r_E_at_D_plus_d_T0"] = bearings.relative_load(of, disc="end")
    r = bearings.pulley_reactions(of, pretension=20)
    found["reactions_T20"] = {name: getattr(r, name) for name in check["output"]["reactions_T20"]}
    return found


def of_capstan(check: Check) -> dict[str, Any]:
    name = {"C25": "C25P104GX", "C35": "C35P75GX"}[check["name"].rsplit(".", 1)[-1]]
    found = bearings.capstan_reactions(bench.configuration(name))
    return {"A_y": found.A_y, "B_y": found.B_y}


def of_cable(check: Check) -> dict[str, Any]:
    centres = 1e-3 * check["input"]["centres_mm"]
    return {name: bearings.cable_pull(bench.configuration(name), 1.0, centres=centres) for name in CENTRED}


def of_motor_torque(check: Check) -> dict[str, Any]:
    g = check["input"]
    return {"T_m": reactive_torque([g["F1"]], [g["F2"]], lever=g["lever_m"])[0]}


def of_rigid(check: Check) -> dict[str, Any]:
    g = check["input"]
    found = drive.motor_torque(
        speed=g["dtheta"],
        acceleration=g["ddtheta"],
        ratio=g["N"],
        inertias=(g["J_M"], g["J_1"], g["J_2"], g["J_L"]),
        viscous=(g["B_M"], g["B_L"]),
        load_torque=g["T_L"],
        friction=g["T_fs"],
    )
    return {"T_M": found}


def of_threshold(check: Check) -> dict[str, Any]:
    return {"threshold": universal_threshold(check["input"]["N"], sigma=check["input"]["sigma"])}


def of_dynamic_lugre(check: Check) -> dict[str, Any]:
    g = check["input"]
    time = np.linspace(0.0, 1.0, 2001)
    z, torque = drive.dynamic_lugre(
        time,
        velocity=10 * np.sin(2 * np.pi * time),
        curve=models.Lugre(F_c=g["F_c"], F_s=g["F_s"], theta_s=g["theta_s"], F_v=0.0, alpha=g["alpha"]).curve,
        bristle=_core.friction.Presliding(bristle_stiffness=g["sigma_0"], bristle_damping=g["sigma_1"]),
        viscous=g["sigma_2"],
    )
    at = np.round(2000 * np.array(g["t"])).astype(int)
    return {"z": z[at], "T": torque[at]}


def of_stiffness(check: Check) -> dict[str, Any]:
    g = check["input"]
    of = bench.configuration("C25P104GX")
    assert of.radii() == pytest.approx((g["r_c"], g["r_p"]), rel=1e-15)
    k = drive.torsional_stiffness(
        of,
        load_torque=g["T_L"],
        pretension=g["T_pr"],
        axial_stiffness=g["EA"],
        friction=g["mu"],
        centres=g["centres"],
    )
    return {"k": k}


COMPUTED: dict[str, Callable[[Check], dict[str, Any]]] = {
    "twin": of_twin,
    "proposed": of_proposed,
    "table8": of_table8,
    "lugre_fit": of_lugre_fit,
    "lugre_static": of_lugre,
    "relative_load": of_relative_load,
    "capstan": of_capstan,
    "cable": of_cable,
    "motor_torque": of_motor_torque,
    "rigid": of_rigid,
    "viscous_factor": lambda check: {"factor": drive.viscous_factor(check["input"]["N"])},
    "denoise": of_threshold,
    "lugre_dynamic": of_dynamic_lugre,
    "stiffness": of_stiffness,
}


def flat(value: Any) -> list[float]:
    """The numbers in nested tables and lists, in order."""
    if isinstance(value, Mapping):
        return [x for v in value.values() for x in flat(v)]
    if isinstance(value, (list, tuple)):
        return [x for v in value for x in flat(v)]
    return [float(x) for x in np.ravel(value)]


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check["name"])
def test_check(check: Check) -> None:
    found = COMPUTED[check["name"].split(".")[0]](check)
    assert found.keys() == check["output"].keys()
    assert flat(found) == pytest.approx(flat(check["output"]), rel=check["rtol"], abs=0.0)


def test_all_checks_are_there() -> None:
    assert len(CHECKS) == 74


@pytest.mark.parametrize("transmission", bench.TRANSMISSIONS)
def test_the_parameter_sets_are_those_of_the_tables(transmission: str) -> None:
    given = SETS[transmission]
    assert bench.configuration(transmission).ratio() == pytest.approx(given["N"], rel=1e-15)
    for which in models.PROPOSED_SETS:
        found = models.reconstructed(transmission, which).values()
        assert found == pytest.approx([given[which][n] for n in fits.NAMES], rel=1e-12)
    speed, load, torque = twin.points(transmission)
    ratio = given["N"]
    errors = {
        "lugre_printed": models.printed_lugre(transmission).torque(speed) - torque,
        "identified": models.reconstructed(transmission, "identified_on_twin").torque(speed, load=load, ratio=ratio)
        - torque,
        "table8_set": models.reconstructed(transmission).torque(speed, load=load, ratio=ratio) - torque,
    }
    for name, error in errors.items():
        assert np.sqrt(np.mean(error**2)) == pytest.approx(given["rms_on_twin"][name], rel=1e-9)
