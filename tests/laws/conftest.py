"""Every law of the library, each with a value for every parameter that is inside its bounds."""

from dataclasses import dataclass
from typing import Any

from tendonlab import _core


@dataclass(frozen=True)
class Case:
    """A registered law; `make` builds it at its typical values, moved by `changes`."""

    group: str
    name: str

    @property
    def law(self) -> Any:
        pascal = "".join(part.title() for part in self.name.split("_"))
        return getattr(getattr(_core, self.group), pascal)

    @property
    def amplitudes(self) -> tuple[str, ...]:
        return tuple(p.name for p in self.law.parameters if p.purpose in ("amplitude", "share"))

    def make(self, **changes: float) -> Any:
        return self.law(**{**{p.name: p.typical for p in self.law.parameters}, **changes})

    def off(self) -> Any:
        return self.make(**dict.fromkeys(self.amplitudes, 0.0))

    def __str__(self) -> str:
        return f"{self.group}:{self.name}"


def pytest_generate_tests(metafunc: Any) -> None:
    """`law`: every registered law, or those in one of the roles that the test's mark `roles` names and not in `but`."""
    if "law" not in metafunc.fixturenames:
        return
    marker = metafunc.definition.get_closest_marker("roles")
    cases = [Case(group, name) for group, name in _core.laws()]
    wanted = [c for c in cases if marker is None or _takes(marker, c)]
    metafunc.parametrize("law", wanted, ids=str)


def _takes(marker: Any, case: Case) -> bool:
    roles = set(case.law.roles)
    right_group = case.group == marker.kwargs.get("group", case.group)
    return right_group and bool(set(marker.args) & roles) and marker.kwargs.get("but") not in roles


def pytest_configure(config: Any) -> None:
    config.addinivalue_line("markers", "roles(*names, but, group): run on the laws in one of these roles")
