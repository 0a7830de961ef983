"""report.html: one file that needs nothing else, says the verdict and escapes what users wrote."""

from __future__ import annotations

import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tendonlab.errors import ParameterError
from tendonlab.report import effects_table
from tendonlab.report.blocks import Text
from tendonlab.report.diagnosis import Diagnosis, SideTable
from tendonlab.report.document import _facts
from tendonlab.report.figures import LARGEST_SVG, embed
from tendonlab.report.sections.location import location
from tendonlab.report.write import prepare_folder

NASTY = "<script>alert(\"rig\")</script> & $x$ 'quoted'"


class Page(HTMLParser):
    """Checks that elements nest; collects text, ids and the targets of references."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.text: list[str] = []
        self.ids: list[str] = []
        self.targets: list[str] = []
        self.scripts = 0
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_startendtag(tag, attrs)
        if tag not in {"meta", "br", "img"}:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.scripts += tag == "script"
        self.ids += [value or "" for name, value in attrs if name == "id"]
        self.targets += [value or "" for name, value in attrs if name in {"href", "src"}]

    def handle_endtag(self, tag: str) -> None:
        assert self.open, f"</{tag}> without a start"
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text.append(data)


def read(diagnosis: Diagnosis, folder: Path) -> tuple[str, Page]:
    text = diagnosis.report(folder, figures=False).read_text(encoding="utf-8")
    return text, Page(text)


def test_page_is_well_formed_and_self_contained(diagnosis: Diagnosis, tmp_path: Path) -> None:
    text, page = read(diagnosis, tmp_path)
    assert page.open == []
    assert not re.search(r"https?:|//\w+\.|@import|url\((?!#)", text)
    assert all(target.startswith(("#", "data:image/png;base64,")) for target in page.targets)
    assert len(page.ids) == len(set(page.ids))
    assert {target[1:] for target in page.targets if target.startswith("#")} <= set(page.ids)
    assert set(re.findall(r"url\(#([^)]+)\)", text)) <= set(page.ids)


def test_names_in_code_never_break(with_effect: Diagnosis, tmp_path: Path) -> None:
    text, _ = read(with_effect, tmp_path)
    (style,) = re.findall(r"^code {(.*)}$", text, re.MULTILINE)
    assert "white-space: nowrap" in style
    assert "overflow-wrap" not in style
    assert f"<code>{with_effect.effects[0].name}</code>" in text


def test_page_holds_the_sentence_and_the_four_answers(diagnosis: Diagnosis, tmp_path: Path) -> None:
    words = " ".join(read(diagnosis, tmp_path)[1].text)
    assert diagnosis.sentence in words
    judged = () if diagnosis.verdict == "data_fault" else ("Where", "Which")
    for heading in (*judged, "How far", "What next", "Warnings", "How this was computed"):
        assert heading in words
    assert ("not yet calibrated" in words) is not diagnosis.calibrated


def test_files_written_hold_the_same_bytes_each_time(with_effect: Diagnosis, tmp_path: Path) -> None:
    first, second = with_effect.report(tmp_path / "a" / "b"), with_effect.report(tmp_path / "c")
    assert first == tmp_path / "a" / "b" / "report.html"
    figures = {f"{name}.{kind}" for name in ("gap", "overlay", "where", "effects") for kind in ("svg", "png")}
    assert {path.name for path in first.parent.iterdir()} == figures | {"report.html", "report.json"}
    for path in first.parent.iterdir():
        assert path.read_bytes() == (second.parent / path.name).read_bytes(), path.name


def test_without_figures_there_are_two_files(with_effect: Diagnosis, tmp_path: Path) -> None:
    with_effect.report(tmp_path, figures=False)
    assert {path.name for path in tmp_path.iterdir()} == {"report.html", "report.json"}


def test_a_report_that_fails_leaves_the_earlier_one(with_effect: Diagnosis, tmp_path: Path) -> None:
    bare = replace(with_effect, overlays=(), where_map=())
    bare.report(tmp_path, figures=False)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(ParameterError, match="complex"):
        replace(bare, seed=7, details={"odd": 2j}).report(tmp_path, figures=False)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_folder_is_made_before_there_is_anything_to_write(tmp_path: Path) -> None:
    assert prepare_folder(tmp_path / "a" / "b").is_dir()
    assert list((tmp_path / "a" / "b").iterdir()) == []
    (tmp_path / "file").touch()
    with pytest.raises(ParameterError, match="file' is a file: expected a folder"):
        prepare_folder(tmp_path / "file")
    with pytest.raises(OSError, match="file"):
        prepare_folder(tmp_path / "file" / "below")


def test_text_of_users_is_escaped(with_effect: Diagnosis, tmp_path: Path) -> None:
    (run,) = with_effect.overlays
    signals = {
        stage: {NASTY: getattr(run, stage)["joint_angle"]}
        for stage in ("measured", "nominal", "refitted", "with_effect")
    }
    nasty = replace(
        with_effect,
        dataset=NASTY,
        warnings=(NASTY,),
        gap={NASTY: with_effect.gap["joint_angle"]},
        units={NASTY: NASTY},
        overlays=(replace(run, name=NASTY, floor={NASTY: 1e-3}, **signals),),
        next_experiments=({"description": NASTY, "separates": [NASTY], "expected_gain": None},),
        table=SideTable(title=NASTY, note=NASTY, frame=pd.DataFrame({NASTY: [NASTY]})),
        details={NASTY: NASTY},
    )
    text, page = read(nasty, tmp_path)
    assert page.scripts == 0
    assert page.open == []
    assert "<script" not in text
    assert NASTY in " ".join(page.text)
    assert "<script" not in nasty._repr_html_()


def test_a_large_figure_is_embedded_as_png() -> None:
    def shown(path: str) -> str:
        return embed(f'<svg width="1"><path d="{path}"/></svg>', lambda: b"png", name="a", alt="what <it> shows")

    assert shown("M 0 0").startswith("<svg")
    large = shown("M 0 0 " * LARGEST_SVG)
    assert large.startswith("<img")
    assert "data:image/png;base64,cG5n" in large
    assert "what &lt;it&gt; shows" in large


def test_empty_results_still_make_a_page(with_effect: Diagnosis, tmp_path: Path) -> None:
    bare = replace(
        with_effect,
        verdict="unknown_effect",
        gap={},
        where={"signals": [], "elements": [], "regimes": []},
        effects=(),
        sets=(),
        selected=(),
        explained=None,
        shrinkage={"from_nominal": None, "from_refitted": None},
        overlays=(),
        where_map=(),
        held_out=pd.DataFrame(),
        indistinguishable=(),
        invisible=(),
        next_experiments=(),
        table=None,
    )
    words = " ".join(read(bare, tmp_path)[1].text)
    assert "No output could be scored" in words
    assert "no effect of the library explains" in words


def test_a_held_out_run_without_a_gap_has_no_shrinkage(undrawn: Diagnosis, tmp_path: Path) -> None:
    table = pd.DataFrame({"nominal": [2.0], "refitted": [0.0], "with_effect": [np.nan]}, index=["quiet"])
    text, _ = read(replace(undrawn, held_out=table), tmp_path)
    assert '<td>quiet</td><td class="n">2</td><td class="n">0</td><td class="n">–</td><td class="n">–</td>' in text


def test_notebook_form_is_short(with_effect: Diagnosis) -> None:
    assert repr(with_effect) == "Diagnosis('rig-42', verdict='effect', selected=['joint:stribeck'])"
    html = with_effect._repr_html_()
    assert with_effect.sentence in html
    assert effects_table(with_effect) in html


@pytest.mark.parametrize("count", [3, 40])
def test_a_selected_effect_is_listed_however_many_candidates_there_are(with_effect: Diagnosis, count: int) -> None:
    template = with_effect.effects[0]
    many = tuple(replace(template, effect=f"law_{index}", probability=0.5) for index in range(count))
    chosen = many[-1].name
    assert f"<code>{chosen}</code>" in effects_table(replace(with_effect, effects=many, selected=(chosen,)))


def test_candidates_that_no_fit_speaks_of_are_counted(with_effect: Diagnosis, tmp_path: Path) -> None:
    bare = replace(with_effect.effects[-1], effect="bias", parameters={}, held_out_gain=None, probability=0.0)
    told = replace(with_effect, effects=(*with_effect.effects, bare))
    without, page = (read(diagnosis, tmp_path)[0] for diagnosis in (with_effect, told))
    assert "have no fit" not in without
    assert "1 of all candidates have no fit" in page


def test_all_held_out_runs_are_on_the_page_all_but_the_worst_folded(with_effect: Diagnosis, tmp_path: Path) -> None:
    (run,) = with_effect.overlays
    inputs = {"motor_torque": np.zeros_like(run.time)}
    text, _ = read(replace(with_effect, overlays=(run, replace(run, name="push", inputs=inputs))), tmp_path)
    folded = text[text.index("<details>") : text.index("</details>")]
    assert "Held-out experiment push, drawn" in folded
    assert "At the bottom: the logged inputs." in folded
    assert "Held-out experiment swing-7" not in folded
    assert "Held-out experiment swing-7: measurements" in text


def test_caption_says_what_the_overlay_leaves_out(with_effect: Diagnosis, tmp_path: Path) -> None:
    (run,) = with_effect.overlays
    names = [f"tension_{index}" for index in range(6)]
    swing = np.sin(60.0 * run.time)
    parts = {stage: dict.fromkeys(names, swing) for stage in ("measured", "nominal", "refitted", "with_effect")}
    long = replace(with_effect, overlays=(replace(run, floor=dict.fromkeys(names, 0.1), **parts),))
    text, _ = read(long, tmp_path)
    assert re.search(r"Shown: 0 to [\d.]+ s of the run.* The 4 outputs that carry most of the gap are drawn", text)
    assert "Shown:" not in read(with_effect, tmp_path)[0]


def test_numbers_in_figures_are_those_of_the_tables(undrawn: Diagnosis, tmp_path: Path) -> None:
    """Coordinates of the drawing are shortened for the page, the text in it is not."""
    gap = {"joint_angle": {"noise_floor": 0.264e-3, "nominal": 2.3e-3, "refitted": 0.996e-3, "with_effect": 0.348e-3}}
    text, _ = read(replace(undrawn, gap=gap), tmp_path)
    assert all(f"{value} mrad" in text for value in ("2.3", "0.996", "0.348"))
    assert all(f'<td class="n">{value}</td>' in text for value in ("2.3", "0.996"))


def test_elements_that_are_ruled_out_share_a_row(undrawn: Diagnosis, tmp_path: Path) -> None:
    elements = [{"element": name, "probability": p} for name, p in (("joint", 0.9), ("cable", 0.0), ("motor", 0.001))]
    page = read(replace(undrawn, where={**undrawn.where, "elements": elements}), tmp_path)[1]
    assert "2 other elements" in page.text
    assert "Cable" not in page.text


def test_figures_say_in_words_that_held_out_runs_got_worse(with_effect: Diagnosis) -> None:
    worse = {"value": -5.3, "ci95": [-8.0, -2.0]}
    of_both = replace(with_effect, shrinkage={"from_nominal": worse, "from_refitted": worse})
    of_tuning = replace(of_both, selected=(), verdict="parameters_only")
    after = "tuning and the added effects made held-out runs worse"
    assert _facts(of_both)[1] == ("6.3 times as large", "as the held-out gap of the simulator as stated", after)
    assert _facts(of_both)[2][1:] == ("as the held-out gap after tuning", "the added effects made held-out runs worse")
    assert _facts(of_tuning)[1][2] == "tuning made held-out runs worse"


def test_the_summary_names_no_regime_that_chance_explains(undrawn: Diagnosis, tmp_path: Path) -> None:
    regimes = [
        {"coordinate": "joint_velocity", "range": [0.0, 0.05], "share": 0.4, "p_value": 0.01},
        {"coordinate": "time", "range": [8.0, 12.0], "share": 0.9, "p_value": 0.2},
    ]
    words = " ".join(read(replace(undrawn, where={**undrawn.where, "regimes": regimes}), tmp_path)[1].text)
    assert "mainly at joint velocity 0 to 0.05 rad/s (40 % of the excess)" in words


def test_fitted_parameters_and_settings_carry_their_units(undrawn: Diagnosis, tmp_path: Path) -> None:
    stiffness = {"value": 42.0, "nominal": None, "ci95": [40.0, 44.0], "unit": "N*m/rad"}
    details = {"parameters": {"cable_stiffness": stiffness}, "noise": {"joint_angle": 2.1e-4}}
    page = read(replace(undrawn, details=details), tmp_path)[1]
    assert {"Parameters with the effect", "Cable stiffness ", "(N·m/rad)", "40 to 44"} <= set(page.text)
    assert "joint angle 210 µrad (standard deviation)" in page.text


def test_parameters_that_nothing_informs_show_no_interval(undrawn: Diagnosis, tmp_path: Path) -> None:
    silent = {"value": 0.01, "ci95": [0.004, 0.016], "unit": "m", "nominal": 0.01, "informed": False}
    page = read(replace(undrawn, details={"parameters": {"motor_radius_2": silent}}), tmp_path)[1]
    assert "held: a small change has no effect" in page.text
    assert not {"4 to 16", "0.004 to 0.016"} & set(page.text)


def test_problems_of_the_logs_are_shown_only_where_there_are_some(undrawn: Diagnosis, tmp_path: Path) -> None:
    quiet = " ".join(read(undrawn, tmp_path)[1].text)
    assert "what looks wrong with the logs" not in quiet
    lag = {"problem": "clock", "signal": None, "experiment": "swing-7", "detail": "lags the others by 20 ms"}
    loud = replace(undrawn, data=({**lag, "blocks": True},))
    words = " ".join(read(loud, tmp_path)[1].text)
    assert "Clock: lags the others by 20 ms" in words
    assert "(experiment swing-7; must be corrected before a diagnosis)" in words
    assert loud.to_dict()["data"] == [{**lag, "blocks": True}]


def test_a_problem_of_several_experiments_is_told_once(undrawn: Diagnosis, tmp_path: Path) -> None:
    limit = {"problem": "saturation", "signal": "motor_torque", "blocks": False, "detail": "stays at 3 N·m"}
    noted = tuple({**limit, "experiment": f"swing-{i}"} for i in (1, 2, 5))
    words = " ".join(read(replace(undrawn, data=noted), tmp_path)[1].text)
    assert words.count("stays at 3 N·m") == 1
    assert "(signal motor_torque; experiment swing-1; alike in swing-2, swing-5)" in words


def test_gains_of_the_replay_carry_their_units(undrawn: Diagnosis, tmp_path: Path) -> None:
    replay = {"kind": "injection", "kp": 0.8, "kd": 0.01, "kp_unit": "N*m/rad", "kd_unit": "N*m*s/rad"}
    words = " ".join(read(replace(undrawn, replay=replay), tmp_path)[1].text)
    assert "kp = 0.8 N·m/rad; kd = 0.01 N·m·s/rad." in words


def test_caveats_stand_below_the_verdict(with_effect: Diagnosis, tmp_path: Path) -> None:
    text, _ = read(replace(with_effect, caveats=("inertia was <fitted> far away.",)), tmp_path)
    head = text[text.index("<h1>") : text.index("</header>")]
    assert "Inertia was &lt;fitted&gt; far away." in head
    assert 'class="caveat"' not in read(with_effect, tmp_path)[0]


def test_an_element_is_named_in_words_only_where_it_is_likely(with_effect: Diagnosis, tmp_path: Path) -> None:
    elements = [{"element": "joint", "probability": 0.19}, {"element": "motor", "probability": 0.02}]
    unsure = replace(with_effect, where={**with_effect.where, "elements": elements})
    assert "most likely comes from" not in read(unsure, tmp_path)[0]
    assert "The remaining error is largest" in read(unsure, tmp_path)[0]
    none = [{"signal": "joint_angle", "share": 0.0}, {"signal": "motor_angle", "share": 0.0}]
    at_floor = read(replace(unsure, where={**unsure.where, "signals": none}), tmp_path)[0]
    assert "On held-out experiments no output errs beyond its noise floor." in at_floor
    assert "is largest" not in at_floor
    assert "most likely comes from" in read(with_effect, tmp_path)[0]


def test_at_the_floor_no_output_is_said_to_carry_the_error(with_effect: Diagnosis) -> None:
    gap = {"joint_angle": {"noise_floor": 1.0, "nominal": 9.0, "refitted": 1.02, "with_effect": 1.0}}
    brief = location(replace(with_effect, gap=gap))[0]
    assert isinstance(brief, Text)
    assert "no output errs by more than 1.1 times its noise floor." in brief.text
    assert "is largest" not in brief.text
    weighed = {**with_effect.details, "weighed_by": {"errors": {"refitted": 3.0, "with_effect": 1.0}}}
    elsewhere = location(replace(with_effect, gap=gap, details=weighed))[0]
    assert isinstance(elsewhere, Text)
    assert "is largest" in elsewhere.text  # the shares are those of another loop than the one shown


@pytest.mark.parametrize(
    ("probability", "source"), [(0.97, "the joint and the actuator"), (0.48, "the joint or the actuator")]
)
def test_elements_that_are_as_probable_are_named_together(
    probability: float, source: str, with_effect: Diagnosis, tmp_path: Path
) -> None:
    shares = {"motor": 0.3, "joint": probability, "actuation": probability - 0.005}
    elements = [{"element": name, "probability": p} for name, p in shares.items()]
    both = replace(with_effect, where={**with_effect.where, "elements": elements})
    assert f"most likely comes from {source} (probability {probability} each)." in read(both, tmp_path)[0]
    none = [{"signal": "joint_angle", "share": 0.0}]
    missing = replace(both, verdict="unknown_effect", where={**both.where, "signals": none})
    assert "What is missing shows in the training experiments." in read(missing, tmp_path)[0]
