"""Bad input to S1's own functions is refused by name."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.papers import s1


def decompose(constant: float = 1.0, viscous: float = 1.0, arm: float = 0.1, share: float = 0.5) -> Any:
    shares = np.array([share, 0.5])
    return s1.decompose(constant, viscous, [arm, 0.1], shares_static=shares, shares_viscous=shares)


BAD: dict[str, tuple[str, Callable[[Path], Any]]] = {
    **{
        f"first_joints({n})": ("num_joints = ", lambda _, n=n: s1.first_joints(s1.example_device(), n))
        for n in (-1, 0, 5, 1.5, True)
    },
    **{
        f"free_motion({name}={value})": (
            f"{name} = ",
            lambda _, name=name, value=value: s1.free_motion(**{name: value}),
        )
        for name in ("duration", "sample_time")
        for value in (0.0, -1.0, np.nan, np.inf)
    },
    "decompose, constant": ("constant = nan", lambda _: decompose(constant=np.nan)),
    "decompose, viscous": ("viscous = nan", lambda _: decompose(viscous=np.nan)),
    "decompose, branches": (r"branch_per_motor\[0\] = nan", lambda _: decompose(arm=np.nan)),
    "decompose, shares": (r"shares_static\[0\] = nan", lambda _: decompose(share=np.nan)),
    **{
        f"write_dataset({levels})": ("levels", lambda to, levels=levels: s1.write_dataset(to / "new", levels=levels))
        for levels in ((), (1.0, 0.0), (-1.0,), (np.nan,), (np.inf,))
    },
    **{
        f"reducer_loop({joint})": ("joint = ", lambda _, joint=joint: s1.reducer_loop(joint=joint))
        for joint in (0, 5, 1.5)
    },
}


@pytest.mark.parametrize("name", BAD)
def test_s1_refuses(name: str, tmp_path: Path) -> None:
    said, call = BAD[name]
    with pytest.raises(ParameterError, match=said):
        call(tmp_path)
    assert not list(tmp_path.iterdir())
