"""What a dataset is asked for: an experiment by its name, and a diagnosis of what it can tell."""

from dataclasses import replace

import pytest

import tendonlab as tl
from tendonlab.cli.demo import bundled
from tendonlab.data import load
from tendonlab.errors import DatasetError, ParameterError


def test_experiments_are_looked_up_by_name(draft, write):
    dataset = load(write(draft))
    assert "one" in dataset
    assert dataset["two"] in dataset
    assert "won" not in dataset


@pytest.mark.parametrize("entry", [tl.diagnose, tl.identify, tl.check])
def test_a_simulator_of_another_kind_is_refused(draft, write, entry):
    other = tl.load(bundled()).system()
    with pytest.raises(ParameterError, match="system is a two_inertia, and tiny a rigid_joint: expected the same kind"):
        entry(load(write(draft)), system=other)


def test_a_column_may_have_any_name_that_the_dataset_says(draft, write):
    """Even one that begins with #, as numpy.savetxt writes the first."""
    draft.frames = {name: frame.rename(columns={"t": "# t"}) for name, frame in draft.frames.items()}
    draft.toml["time"] = {**draft.toml.get("time", {}), "column": "# t"}
    assert load(write(draft)).name == "tiny"


def test_a_run_of_a_few_samples_is_no_motion_to_diagnose(draft, write):
    dataset = load(write(draft))
    short = tuple(replace(e, data=e.data.iloc[:3]) for e in dataset)
    with pytest.raises(DatasetError, match="one has 3 samples: expected at least 16; leave it out"):
        tl.diagnose(replace(dataset, experiments=short), force=True)
