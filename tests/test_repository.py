"""What the repository promises of itself: small files, short functions, no trace of a machine."""

import ast
import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
NOT_OURS = {"build", "dist", "out", "__pycache__"}  # and whatever starts with a dot or ends in .egg-info
LARGEST_FILE, LARGEST_DATA = 1_000_000, 5_000_000  # bytes
MOST_LINES, MOST_LINES_OF_A_FUNCTION = 400, 60


def tracked() -> list[Path]:
    """Every file of the repository; in an unpacked source distribution every file of the tree."""
    if (ROOT / ".git").exists():
        listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, encoding="utf-8", check=True)
        return [path for name in listed.stdout.split("\0") if name and (path := ROOT / name).is_file()]
    return [path for path in ROOT.rglob("*") if path.is_file() and not foreign(path.relative_to(ROOT))]


def foreign(path: Path) -> bool:
    hidden = any(part.startswith(".") and part != ".ci" for part in path.parts[:-1])
    return hidden or any(part in NOT_OURS or part.endswith(".egg-info") for part in path.parts)


FILES = tracked()
SOURCES = [path for path in FILES if path.suffix in (".py", ".pyi", ".cpp", ".hpp", ".j2")]
PYTHON = [path for path in SOURCES if path.suffix == ".py"]
CPP = [path for path in SOURCES if path.suffix in (".cpp", ".hpp")]


def named(path: Path) -> str:
    return str(path.relative_to(ROOT))


def lines_of_python_functions(text: str) -> Iterator[tuple[str, int]]:
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name, (node.end_lineno or node.lineno) - node.lineno + 1


def lines_of_cpp_blocks(text: str) -> Iterator[tuple[str, int]]:
    """Heading and length of every block in braces but namespaces and classes: functions and what is in them."""
    opened: list[tuple[str, int]] = []
    heading, line = "", 1
    for letter in without_comments_and_strings(text):
        line += letter == "\n"
        if letter == "{":
            opened.append((heading.strip(), line - heading.strip().count("\n")))
        elif letter == "}":
            what, start = opened.pop()
            if not re.match(
                r"(template\s*<.*>\s*)?(inline\s+)?(namespace|class|struct|union|enum|extern)\b", what, re.S
            ):
                yield what, line - start + 1
        heading = "" if letter in "{};" else heading + letter


def without_comments_and_strings(text: str) -> str:
    """`text` without directives, comments, strings and characters, line for line; 20'000 is a number, no character."""
    pattern = r'^[ \t]*#(?:\\.|[^\\\n])*|//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|(?<![0-9A-Fa-f])\'(?:\\.|[^\'\\\n])+\''
    return re.sub(pattern, lambda found: "\n" * found.group().count("\n"), text, flags=re.S | re.M)


def test_files_are_small() -> None:
    assert {named(path): path.stat().st_size for path in FILES if path.stat().st_size > LARGEST_FILE} == {}
    assert sum(path.stat().st_size for path in FILES if named(path).startswith("data/")) < LARGEST_DATA


def test_sources_are_short() -> None:
    counts = {named(path): len(path.read_text(encoding="utf-8").splitlines()) for path in SOURCES}
    assert {name: count for name, count in counts.items() if count > MOST_LINES} == {}


def test_functions_are_short() -> None:
    long = {}
    for path in (*PYTHON, *CPP):
        measure = lines_of_python_functions if path.suffix == ".py" else lines_of_cpp_blocks
        for name, count in measure(path.read_text(encoding="utf-8")):
            if count > MOST_LINES_OF_A_FUNCTION:
                long[f"{named(path)}: {name}"] = count
    assert long == {}


def test_the_brace_counter_counts() -> None:
    """A namespace and a struct are no functions; a brace in a string or a comment is no brace."""
    text = '#include <b>\nnamespace a {\nstruct B {\n  int f(int x) {  // {\n    return "{"[x];\n  }\n};\n}\n'
    assert list(lines_of_cpp_blocks(text)) == [("int f(int x)", 3)]


def test_no_path_of_a_machine_is_in_a_file() -> None:
    """Not even in a notebook or a table: what depends on a machine works on no other."""
    pattern = re.compile(r"(?<![\w.*}/])/(?:home|root|Users|work|tmp|mnt)/\w")
    found = []
    for path in FILES:
        if path.suffix in (".png", ".npz", ".mat", ".h5", ".parquet"):
            continue
        found += [f"{named(path)}: {hit.group()}" for hit in pattern.finditer(path.read_text(encoding="utf-8"))]
    assert found == []
