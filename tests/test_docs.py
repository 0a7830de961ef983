"""The documentation agrees with the program: its links, commands, keys, effects and systems exist."""

import dataclasses
import re
import shlex
from collections.abc import Iterator, Mapping
from typing import Any

import pytest

import tendonlab as tl
from tendonlab.cli import commands as cli
from tendonlab.data.schema import Table
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.simulation.catalog import kinds, system_info
from test_repository import FILES, ROOT, named
from twin import TwinDiagnosis

PAGES = {named(path): path.read_text(encoding="utf-8") for path in FILES if path.suffix == ".md"}
DATASETS = PAGES["docs/datasets.md"]
TEXTS = (".py", ".pyi", ".cpp", ".hpp", ".in", ".j2", ".md", ".ipynb", ".toml", ".txt", ".cff", ".yaml", "")
NOT_SHIPPED = [name.upper() for name in ("diagnosis", "formats", "design", "style", "core", "build")]
DRAWN_ONLY = {
    "units",
    "overlays",
    "where_map",
    "table",
    "references",
}  # of a Diagnosis: for the page, not for report.json
BY_NAME = {"effects", "gap", "parameters", "noise", "rms", "held_out"}  # of report.json: keyed by names of the rig


def blocks(language: str) -> Iterator[str]:
    for text in PAGES.values():
        yield from re.findall(rf"```{language}\n(.*?)```", text, re.S)


@pytest.mark.parametrize("page", PAGES)
def test_relative_links_resolve(page: str) -> None:
    for target, _, anchor in re.findall(r"\]\(([^)#\s]*)(#([^)\s]+))?\)", PAGES[page]):
        if "://" in target:
            continue
        path = (ROOT / page).parent / target if target else ROOT / page
        assert path.exists(), target
        if anchor:
            assert anchor in anchors(path.read_text(encoding="utf-8")), f"{target}#{anchor}"


def anchors(text: str) -> set[str]:
    headings = re.findall(r"^#+ (.*)$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_no_text_refers_to_a_document_that_does_not_ship() -> None:
    pattern = re.compile(rf"\b({'|'.join(NOT_SHIPPED)})(\.md|:? (section|sec\.|\d))")
    found = []
    for path in FILES:
        if path.suffix in TEXTS:
            found += [f"{named(path)}: {hit.group()}" for hit in pattern.finditer(path.read_text(encoding="utf-8"))]
    assert found == []


@pytest.mark.parametrize("line", [line for block in blocks("sh") for line in block.splitlines()])
def test_commands_exist(line: str) -> None:
    program, *arguments = shlex.split(line.replace("python -m tendonlab.blind", "tendonlab blind"))
    assert program == "tendonlab"
    assert cli._parser().parse_args(arguments).run.__name__ != "explain"


def test_options_of_the_build_exist() -> None:
    options = {name for text in PAGES.values() for name in re.findall(r"\b(TENDONLAB_[A-Z]+)\b", text)}
    options -= {"TENDONLAB_DATA", "TENDONLAB_CORE"}  # variables of the environment
    cmake = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    assert options
    assert [name for name in options if not re.search(rf"(option|set)\({name} ", cmake)] == []


def test_effects_exist() -> None:
    effects = {effect.name for kind in kinds() for effect in system_info(kind).effects}
    effects.add("joint:my_law")  # the example of CONTRIBUTING
    for page, text in PAGES.items():
        assert set(re.findall(r"`([a-z_0-9]+(?:\.[a-z_0-9]+)?:[a-z_0-9]+)`", text)) <= effects, page


def test_systems_exist_and_the_readme_offers_each() -> None:
    chooser = PAGES["README.md"].partition("## Which system is mine?")[2].partition("\n## ")[0]
    offered = {name for row in re.findall(r"\| ([^|]*) \|$", chooser, re.M) for name in re.findall(r"`(\w+)`", row)}
    assert offered - {"kind"} == set(kinds())
    of_papers = re.findall(r"^\| S\d \| (`[^|]*) \|", PAGES["docs/papers.md"], re.M)
    assert {name for cell in of_papers for name in re.findall(r"`(\w+)`", cell)} <= set(kinds())


def test_systems_that_the_readme_calls_planned_do_not_exist() -> None:
    limits = PAGES["README.md"].partition("## What it cannot do")[2].partition("\n## ")[0]
    assert "`cable_transmission`" in limits
    assert set(re.findall(r"`(\w+)`", limits)).isdisjoint(kinds())


def test_modules_that_the_method_names_exist() -> None:
    modules = set(re.findall(r"`([\w/]+\.(?:py|hpp))`", PAGES["docs/method.md"]))
    assert len(modules) > 10
    assert [m for m in modules if not any((ROOT / top / m).is_file() for top in ("", "python/tendonlab"))] == []


def test_every_key_of_a_dataset_is_documented(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the reader allows anywhere in dataset.toml has a row of its own."""
    allowed: set[str] = set()
    monkeypatch.setattr(Table, "allow", lambda _, keys: allowed.update(keys))
    tl.load(ROOT / "data" / "two_inertia")
    assert {"format", "kind", "value", "kp", "column", "file"} <= allowed  # all tables were visited
    assert allowed - documented() == set()


def documented() -> set[str]:
    return set(re.findall(r"^\| `(\w+)` \|", DATASETS, re.M)) | {"column", "unit"}  # the latter also of `time`


def test_every_key_of_a_report_is_documented() -> None:
    fields = {field.name for field in dataclasses.fields(Diagnosis)} - DRAWN_ONLY
    assert fields - documented() == set()


def test_every_key_of_the_demo_report_is_documented(twin_diagnosis: TwinDiagnosis) -> None:
    written = set(keys(twin_diagnosis.diagnosis.to_dict()))
    assert "held_out_gain" in written
    missing = {key for key in written - documented() if f"`{key}`" not in DATASETS}
    assert missing == set()


def keys(value: Any) -> Iterator[str]:
    """Keys of a report, without the names of signals, parameters and experiments."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield key
            named_items = list(item.values()) if key in BY_NAME and isinstance(item, Mapping) else [item]
            for inner in named_items:
                yield from keys(inner)
    elif isinstance(value, list):
        for item in value:
            yield from keys(item)
