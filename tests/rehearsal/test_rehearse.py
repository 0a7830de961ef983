"""The whole rehearsal with a stubbed diagnosis: counting, storing, resuming, refusing, leaving out."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

import tendonlab as tl
from rehearsal.stubs import says
from tendonlab.rehearsal import run
from tendonlab.rehearsal.store import CASES
from tendonlab.report.diagnosis import Diagnosis

Stub = Callable[[tl.Dataset], Diagnosis]
FEW = {"effects": ["load:offset"], "sizes": [0.5, 8.0], "repeats_per_size": 2, "progress": False}


@pytest.mark.cpu(15)
def test_a_large_effect_is_found_and_a_small_one_is_not(pendulum: Path, stub: Stub, tmp_path: Path) -> None:
    found = tl.rehearse(tl.load(pendulum), diagnose=stub, out=tmp_path / "out", **FEW)
    entry = found["load:offset"]
    assert [(size.gap, size.tried) for size in entry.sizes] == [(0.5, 2), (8.0, 2)]
    assert entry.sizes[0].amount == pytest.approx(entry.sizes[1].amount / 16, rel=0.1)  # the gap is linear in an offset
    assert entry.sizes[1].found == 2
    assert found.nothing["effect"].num == 4
    assert (tmp_path / "out" / CASES).read_text().count("\n") == 8
    page = found.report(tmp_path / "out").read_text()
    assert "Constant disturbance on the load" in page
    assert "the library&#39;s own laws" in page
    assert "http" not in page.replace("http://www.w3.org", "")  # nothing is fetched
    written = json.loads((tmp_path / "out" / "rehearsal.json").read_text())
    assert written["format"] == "tendonlab-rehearsal/1"
    assert written["effects"][0]["sizes"][1]["found"] == 2


@pytest.mark.cpu(15)
def test_the_same_seed_gives_the_same_rigs(pendulum: Path) -> None:
    seen: list[float] = []

    def note(dataset: tl.Dataset) -> Diagnosis:
        seen.append(float(dataset.experiments[0].data["joint_angle"].sum()))
        return says(None)

    for seed in (4, 4, 5):
        tl.rehearse(pendulum, diagnose=note, seed=seed, **FEW)
    assert seen[:8] == seen[8:16]
    assert not set(seen[:8]) & set(seen[16:])


@pytest.mark.cpu(15)
def test_an_interruption_keeps_what_was_stored_and_the_same_call_goes_on(pendulum: Path, tmp_path: Path) -> None:
    class StopsAtFour:
        calls = 0

        def __call__(self, _: tl.Dataset) -> Diagnosis:
            self.calls += 1
            if self.calls == 4:
                raise KeyboardInterrupt
            return says("load:offset")

    stops_at_four = StopsAtFour()
    first = tl.rehearse(pendulum, diagnose=stops_at_four, out=tmp_path, **FEW)
    assert (first.interrupted, len(first.cases), first.num_left_out) == (True, 3, 5)
    with (tmp_path / CASES).open("a") as file:
        file.write('{"case": "cut sh')  # as a crash leaves it
    second = tl.rehearse(pendulum, diagnose=stops_at_four, out=tmp_path, **FEW)
    assert (second.interrupted, len(second.cases), second.num_left_out) == (False, 8, 0)
    assert stops_at_four.calls == 4 + 5


@pytest.mark.cpu(15)
def test_a_folder_of_other_settings_is_refused_and_says_what_differs(
    pendulum: Path, tmp_path: Path, stub: Stub
) -> None:
    one = {**FEW, "repeats_per_size": 1}
    tl.rehearse(pendulum, diagnose=stub, out=tmp_path, **one)
    more = tl.rehearse(pendulum, diagnose=stub, out=tmp_path, **FEW)  # more of the same may be asked for
    assert len(more.cases) == 8
    with pytest.raises(tl.DatasetError, match=r"differs in sizes and seed.*expected the same settings"):
        tl.rehearse(pendulum, diagnose=stub, out=tmp_path, **{**FEW, "sizes": [1.0, 8.0], "seed": 1})


@pytest.mark.cpu(15)
def test_what_does_not_fit_the_time_is_left_out(pendulum: Path, monkeypatch: pytest.MonkeyPatch, stub: Stub) -> None:
    monkeypatch.setattr(run, "number_that_fits", lambda durations, seconds_left, jobs: 3)
    found = tl.rehearse(pendulum, diagnose=stub, **FEW)
    assert (len(found.cases), found.num_left_out) == (2 + 3, 3)


@pytest.mark.cpu(15)
def test_a_diagnosis_that_fails_counts_as_a_miss(pendulum: Path) -> None:
    def fails(_: tl.Dataset) -> Diagnosis:
        raise tl.NumericalError("no convergence")

    found = tl.rehearse(pendulum, diagnose=fails, **{**FEW, "repeats_per_size": 1})
    assert found["load:offset"].missed == {"failed": 2}
    assert set(found.cases["message"]) == {"NumericalError: no convergence"}
    assert "The diagnosis failed in 2 of 2 rigs" in found.sentences[0]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"effects": ["load:offse"]}, "did you mean 'load:offset'"),
        ({"effects": ["joint:coulomb"]}, "'joint:coulomb' cannot be withheld"),
        ({"effects": "load:offset"}, r"expected a list such as \['joint:stribeck'\]"),
        ({"sizes": []}, "expected gaps over noise"),
        ({"sizes": [1.0, -2.0]}, r"sizes\[1\] = -2.0: expected a value in \(0, inf\)"),
        ({"sizes": [1.0, 1.0]}, "expected each size once"),
        ({"repeats_per_size": 0}, "repeats_per_size = 0: expected a whole number of at least 1"),
        ({"minutes": 0}, "minutes = 0: expected a value in"),
        ({"jobs": 1.5}, "jobs = 1.5: expected a whole number"),
        ({"seed": -1}, "seed = -1"),
    ],
)
def test_bad_arguments(pendulum: Path, options: dict[str, object], message: str) -> None:
    with pytest.raises(tl.ParameterError, match=message):
        tl.rehearse(pendulum, progress=False, **options)  # type: ignore[arg-type]


def test_effects_are_checked_before_anything_is_simulated(pendulum: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def too_early(*_: object) -> None:
        raise AssertionError("a rig was simulated")

    monkeypatch.setattr("tendonlab.rehearsal.rehearse.simulated_rig", too_early)
    with pytest.raises(tl.ParameterError, match="did you mean 'load:offset'"):
        tl.rehearse(pendulum, effects=["load:offse"], progress=False)


@pytest.mark.slow
def test_offsets_are_found_on_a_real_diagnosis(pendulum: Path, tmp_path: Path) -> None:
    """Two processes, the library's own diagnosis: an offset of eight noise floors is no secret."""
    few = {**FEW, "sizes": [8.0], "repeats_per_size": 3}
    found = tl.rehearse(pendulum, jobs=2, minutes=10, out=tmp_path, **few)
    entry = found["load:offset"]
    assert (entry.tried, entry.sizes[0].found) == (3, 3)
    assert found.nothing["effect"].hits == 0
