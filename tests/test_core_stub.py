"""`_core.pyi` says what the compiled core offers: the same names, the same parameters in the same order."""

import ast
import inspect
import re
from pathlib import Path
from types import ModuleType

import pytest

from tendonlab import _core

STUB = ast.parse((Path(__file__).parents[1] / "python" / "tendonlab" / "_core.pyi").read_text(encoding="utf-8"))
ONLY_TYPES = {"Floats", "Laws"}  # names that only the stub has
SHARED = "Law"  # its facts and methods are those of its subclasses, see the last test


def stub_names() -> set[str]:
    found = set()
    for node in STUB.body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            found.add(node.name)
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            found.add(node.target.id)
    return found - ONLY_TYPES


def callables() -> dict[str, list[list[str]]]:
    """Parameter names of every function and method of the stub, a list an overload, by dotted name."""
    found: dict[str, list[list[str]]] = {}
    classes = [node for node in STUB.body if isinstance(node, ast.ClassDef) and node.name not in {*ONLY_TYPES, SHARED}]
    for prefix, body in [("", STUB.body), *((f"{node.name}.", node.body) for node in classes)]:
        for node in body:
            if isinstance(node, ast.FunctionDef):
                names = [arg.arg for arg in (*node.args.args, *node.args.kwonlyargs) if arg.arg != "self"]
                found.setdefault(prefix + node.name, []).append(names)
    return found


def documented(signature: str) -> list[str]:
    """Parameter names in a signature as pybind11 writes it: a name stands after "(" or ", " outside all brackets."""
    inside = signature[signature.index("(") + 1 : signature.rindex(")")]
    depth, outside = 0, ""
    for letter in inside:
        depth += letter in "[({"
        outside += letter if depth == 0 else ""
        depth -= letter in "])}"
    return [name for name in re.findall(r"(?:^|, )(\w+)(?=:)", outside) if name != "self"]


def test_the_stub_and_the_core_have_the_same_names() -> None:
    assert stub_names() == {name for name in dir(_core) if not name.startswith("_")}


@pytest.mark.parametrize("name", sorted(callables()))
def test_parameters_agree(name: str) -> None:
    of: object = _core
    for part in name.split("."):
        of = inspect.getattr_static(of, part)
    if isinstance(of, property):
        assert callables()[name] == [[]]
        return
    lines = (of.__doc__ or "").splitlines()
    signatures = [line for line in lines if re.match(rf"(\d+\. )?{name.split('.')[-1]}\(.*->", line)]
    assert [documented(line) for line in signatures] == callables()[name]


def test_every_member_of_a_class_is_in_the_stub() -> None:
    for node in STUB.body:
        if isinstance(node, ast.ClassDef) and node.name not in {*ONLY_TYPES, SHARED}:
            declared = {item.name for item in node.body if isinstance(item, ast.FunctionDef)} - {"__init__"}
            declared |= {
                item.target.id
                for item in node.body
                if isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name)
            }
            assert declared == {name for name in vars(getattr(_core, node.name)) if not name.startswith("_")}


def test_every_law_has_what_the_stub_says_of_laws() -> None:
    stated = next(node for node in STUB.body if isinstance(node, ast.ClassDef) and node.name == SHARED)
    shared = {
        item.target.id for item in stated.body if isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name)
    }
    groups = [value for value in vars(_core).values() if isinstance(value, ModuleType)]
    laws = [value for group in groups for value in vars(group).values() if isinstance(value, type)]
    assert len(laws) == len(_core.laws())
    for law in laws:
        assert issubclass(law, _core.Law)
        assert all(hasattr(law, name) for name in shared), law
