"""Rooms and their order: imports go down only, in Python and in C++, and nothing shadows a module.

Every import counts: also those inside functions and those for the type checker alone."""

import ast
import importlib
import re
import subprocess
import sys
import types
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "python" / "tendonlab"
CPP = ROOT / "cpp" / "tendonlab"

# A module imports from its own room and from rooms before it.
ROOMS = (
    "_core", "version", "errors", "seed", "arguments", "progress", "threads", "mechanics", "simulation", "sweeping",
    "procedures", "data", "fitting", "identification", "report", "checking", "diagnosis", "rehearsal", "blind",
    "papers", "__init__", "cli", "__main__",
)  # fmt: skip
# Modules outside a folder.
LOOSE = {"__init__", "__main__", "_core", "version", "errors", "seed", "arguments", "progress", "threads"}
# Imports against that order, each with its reason.
UPWARD: dict[tuple[str, str], str] = {}
# Rooms in which modules may need each other, each with its reason.
CIRCLES = {
    "report": "a Diagnosis draws itself: its methods load the plots and pages that show it",
    "rehearsal": "a Rehearsal draws itself, as a Diagnosis does",
}

# The same in C++.
CPP_ROOMS = ("core", "mechanics", "laws", "systems", "integrate", "models", "identify", "bindings")
LAWS = {"friction", "transmission", "actuation", "sensing", "loading"}


def module_name(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts).removesuffix(".__init__")


MODULES = {module_name(path): path for path in (*PACKAGE.rglob("*.py"), PACKAGE / "_core.pyi")}


def imports(name: str) -> Iterator[str]:
    """The modules of the package that a module imports."""
    path = MODULES[name]
    package = name if path.stem == "__init__" else name.rpartition(".")[0]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            yield from (full if (full := f"{base}.{a.name}") in MODULES else base for a in node.names)
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


IMPORTS = {name: {t for t in imports(name) if t in MODULES and t != name} for name in MODULES}


def room(name: str) -> str:
    return name.split(".")[1] if "." in name else "__init__"


def circles(graph: Mapping[str, set[str]]) -> list[set[str]]:
    """Sets of nodes that reach each other."""
    reach = {node: closure(graph, node) for node in graph}
    found = {frozenset({node} | {other for other in reach[node] if node in reach[other]}) for node in graph}
    return [set(circle) for circle in found if len(circle) > 1]


def closure(graph: Mapping[str, set[str]], start: str) -> set[str]:
    seen: set[str] = set()
    todo = list(graph[start])
    while todo:
        node = todo.pop()
        if node not in seen:
            seen.add(node)
            todo.extend(graph.get(node, ()))
    return seen


def upward(edges: Iterable[tuple[str, str]], order: tuple[str, ...]) -> set[tuple[str, str]]:
    return {(one, other) for one, other in edges if order.index(one) < order.index(other)}


def test_the_checks_see_circles_and_upward_arrows() -> None:
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": {"a"}}) == [{"b", "c"}]
    assert upward([("a", "b"), ("b", "a"), ("b", "b")], ("a", "b")) == {("a", "b")}
    assert "tendonlab.simulation.prepare" in IMPORTS["tendonlab.simulation.system"]  # inside a function
    assert "tendonlab.data.dataset" in IMPORTS["tendonlab.data"]


def test_every_module_is_in_a_room() -> None:
    assert {room(name) for name in MODULES} == set(ROOMS)
    assert {path.stem for path in PACKAGE.glob("*.py")} == LOOSE


def test_imports_go_down_the_rooms() -> None:
    edges = [(room(name), room(other)) for name in MODULES for other in IMPORTS[name]]
    assert upward(edges, ROOMS) == set(UPWARD)
    assert len(UPWARD) <= 8


def test_modules_import_each_other_in_no_circle() -> None:
    rooms = Counter(tuple(sorted({room(name) for name in circle})) for circle in circles(IMPORTS))
    assert rooms == {(name,): 1 for name in CIRCLES}


@pytest.mark.parametrize("package", [name for name, path in MODULES.items() if path.stem == "__init__"])
def test_no_attribute_shadows_a_submodule(package: str) -> None:
    owner = importlib.import_module(package)
    children = [name for name in MODULES if name.rpartition(".")[0] == package and not name.endswith("__main__")]
    for child in children:
        importlib.import_module(child)
    for name in getattr(owner, "__all__", ()):
        getattr(owner, name)
    hidden = [child for child in children if not isinstance(getattr(owner, child.rpartition(".")[2]), types.ModuleType)]
    assert hidden == []


def test_the_face_of_the_package_is_stated_alike_for_python_and_the_type_checker() -> None:
    import tendonlab

    tree = ast.parse(MODULES["tendonlab"].read_text(encoding="utf-8"))
    typed = {a.name: n.module for n in ast.walk(tree) if isinstance(n, ast.ImportFrom) for a in n.names}
    homes = {name: home for home, names in tendonlab._HOMES.items() for name in names.split()}
    assert {name: home for name, home in typed.items() if str(home).startswith("tendonlab")} == homes
    assert set(tendonlab.__all__) == set(homes)
    assert set(tendonlab.__all__) <= set(dir(tendonlab))
    with pytest.raises(AttributeError, match="has no attribute 'identity'"):
        tendonlab.identity  # noqa: B018


def test_importing_the_package_loads_no_heavy_library() -> None:
    heavy = ["numpy", "pandas", "scipy", "xarray", "matplotlib", "pint", "tqdm", "tendonlab._core"]
    code = f"import sys, tendonlab, tendonlab.cli.commands as c; c._parser(); print(set({heavy}) & set(sys.modules))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert loaded.strip() == "set()"


def cpp_room(path: Path) -> str:
    folder = path.relative_to(CPP).parts[0]
    return "laws" if folder in LAWS else folder


def includes(path: Path) -> Iterator[Path]:
    for name in re.findall(r'^#include "tendonlab/(.+)"', path.read_text(encoding="utf-8"), re.M):
        if "@" not in name and (CPP / name).exists():  # other headers are made by the build
            yield CPP / name


def test_cpp_includes_go_down_the_rooms_without_circles() -> None:
    files = [path for suffix in ("*.hpp", "*.cpp", "*.cpp.in") for path in CPP.rglob(suffix)]
    edges = [(one, other) for one in files for other in includes(one)]
    against = {(a, b) for a, b in edges if upward([(cpp_room(a), cpp_room(b))], CPP_ROOMS)}
    assert {(str(a.relative_to(CPP)), str(b.relative_to(CPP))) for a, b in against} == set()
    assert circles({str(path): {str(b) for a, b in edges if a == path} for path in files}) == []
