"""Made-up diagnoses."""

from tendonlab.report.diagnosis import Diagnosis, EffectFinding


def says(selected: str | None, *, others: tuple[str, ...] = (), group: tuple[str, ...] = ()) -> Diagnosis:
    """A diagnosis that selects one effect, or none and calls the gap one of parameters."""
    verdict = "effect" if selected else "parameters_only"
    odds = dict.fromkeys(("data_fault", "no_gap", "parameters_only", "effect", "unknown_effect"), 0.0)
    names = [*([selected] if selected else []), *others]
    shares = [0.9, *(0.08 for _ in names)]
    return Diagnosis(
        dataset="stub", system="rigid_joint", seed=0, seconds=0.0, verdict=verdict,
        verdict_probability=odds | {verdict: 0.9, "unknown_effect": 0.1}, replay={"kind": "free"}, gap={},
        where={"signals": [], "elements": [], "regimes": []},
        effects=tuple(
            EffectFinding(element=name.partition(":")[0], effect=name.partition(":")[2], probability=share)
            for name, share in zip(names, shares, strict=False)
        ),
        sets=(), selected=(selected,) if selected else (), explained=None,
        indistinguishable=(group,) if group else (), invisible=(),
        shrinkage={"from_nominal": None, "from_refitted": None}, next_experiments=(), warnings=(),
    )  # fmt: skip
