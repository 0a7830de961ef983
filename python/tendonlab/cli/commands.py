"""The command line: every command is a public function with a printed result."""

from __future__ import annotations

import argparse
import io
import json
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tendonlab.errors import DatasetError, NumericalError, ParameterError

if TYPE_CHECKING:
    from tendonlab.data import Dataset, Experiment
    from tendonlab.report.diagnosis import Diagnosis
    from tendonlab.simulation.system import System

Arguments = argparse.Namespace


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; 0 whatever it found, 2 for what cannot be done as asked, 130 after Ctrl-C."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without "·" shows "?", and the answer stays
    given = _parser().parse_args(argv)
    # The blind protocol shares nothing with the library, its errors included: there a ValueError is meant for the user.
    stated = (ParameterError, DatasetError, NumericalError, *([ValueError] if given.command == "blind" else []))
    try:
        code = int(given.run(given))
        sys.stdout.flush()
        return code
    except stated as error:
        return _complain(f"{type(error).__name__}: {error}")
    except BrokenPipeError:  # the reader of the pipe has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        return _complain(str(error))
    except KeyboardInterrupt as ended:
        return _complain("; ".join(["interrupted", *map(str, ended.args)]), code=130)


def _complain(text: str, *, code: int = 2) -> int:
    print(f"tendonlab: {' '.join(text.split())}", file=sys.stderr)
    return code


def _parser() -> argparse.ArgumentParser:
    from tendonlab import __version__
    from tendonlab.blind.commands import add_parser as add_blind
    from tendonlab.cli.rehearse import add_parser as add_rehearse

    parser = argparse.ArgumentParser(
        prog="tendonlab",
        description="Why does the simulator of a cable- or tendon-driven mechanism miss the rig?",
        epilog="Start with `tendonlab demo`; `tendonlab COMMAND --help` explains a command.",
    )
    parser.add_argument("--version", action="version", version=f"tendonlab {__version__}")
    commands = _commands(parser, dest="command", metavar="COMMAND")
    for add in (_add_demo, _add_check, _add_diagnose, _add_identify, _add_simulate, _add_sweep):
        add(commands)
    add_rehearse(commands)
    for add in (_add_effects, _add_systems, _add_datasets):
        add(commands)
    add_blind(commands)
    return parser


def _commands(parser: argparse.ArgumentParser, *, dest: str, metavar: str) -> Any:
    """Subparsers for several commands; without any of them, the help of all is printed."""

    def explain(_: Arguments) -> int:
        parser.print_help()
        return 0

    parser.set_defaults(run=explain)
    return parser.add_subparsers(dest=dest, metavar=metavar)


def _command(commands: Any, name: str, run: Callable[[Arguments], int], text: str) -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = commands.add_parser(name, help=text, description=text)
    parser.set_defaults(run=run)
    return parser


def _add_demo(commands: Any) -> None:
    parser = _command(commands, "demo", _demo, "diagnose the bundled rig and write its report")
    parser.add_argument("--out", type=Path, default=Path("tendonlab-demo"), metavar="DIR", help="default: %(default)s")
    _add_progress(parser)


def _add_check(commands: Any) -> None:
    parser = _command(commands, "check", _check, "look for wrong signs, units, clocks and samples in the logs")
    parser.add_argument("dataset", metavar="DATASET", help="folder with dataset.toml")
    parser.add_argument("--out", type=Path, metavar="FILE.json", help="write the findings here")


def _add_diagnose(commands: Any) -> None:
    parser = _command(commands, "diagnose", _diagnose, "find out why the simulator misses the rig")
    parser.add_argument("dataset", metavar="DATASET", help="folder with dataset.toml")
    parser.add_argument("--out", type=Path, metavar="DIR", help="write report.html, report.json and figures here")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="default: 0; same seed, same answer")
    text = "weigh these alone, such as joint:stribeck (default: all that the system takes)"
    parser.add_argument("--library", nargs="+", default="default", metavar="EFFECT", help=text)
    parser.add_argument("--force", action="store_true", help="go on although the check of the logs forbids it")
    parser.add_argument("--no-figures", action="store_true", help="write no PNG and SVG beside the report")
    _add_progress(parser)


def _add_identify(commands: Any) -> None:
    parser = _command(commands, "identify", _identify, "fit the free parameters to the training experiments")
    parser.add_argument("dataset", metavar="DATASET", help="folder with dataset.toml")
    _add_effect_names(parser)
    parser.add_argument("--starts", type=int, default=1, metavar="N", help="default: 1 starting point")
    parser.add_argument("--out", type=Path, metavar="FILE.json", help="write the result here")
    _add_progress(parser)


def _add_simulate(commands: Any) -> None:
    parser = _command(commands, "simulate", _simulate, "simulate one experiment and compare it with what was measured")
    parser.add_argument("dataset", metavar="DATASET", help="folder with dataset.toml")
    parser.add_argument("--experiment", metavar="NAME", help="default: the first held-out one")
    _add_effect_names(parser)
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE", help="parameter values, SI")
    parser.add_argument("--out", type=Path, metavar="FILE.csv", help="write t and every simulated output here")


def _add_sweep(commands: Any) -> None:
    parser = _command(commands, "sweep", _sweep, "simulate an experiment at many values of the parameters")
    parser.add_argument("dataset", metavar="DATASET", help="folder with dataset.toml")
    points = parser.add_mutually_exclusive_group(required=True)
    points.add_argument("--grid", nargs="+", metavar="NAME=VALUES", help="as in coulomb=0.1,0.2 viscous=0.01:0.05:9")
    points.add_argument("--points", type=Path, metavar="FILE.csv", help="one point per row, one column per parameter")
    parser.add_argument("--experiment", metavar="NAME", help="default: the first held-out one")
    parser.add_argument("--reduce", metavar="SUMMARY", help="a number per run, such as rms, instead of samples")
    parser.add_argument("--out", metavar="FOLDER", help="store here; the name ends in .zarr or .parquet")
    _add_progress(parser)


def _add_effects(commands: Any) -> None:
    parser = _command(commands, "effects", _effects, "list the effects a system takes, with equations and parameters")
    _add_kinds(parser)


def _add_systems(commands: Any) -> None:
    parser = _command(commands, "systems", _systems, "list the systems, with equations, signals and parameters")
    _add_kinds(parser)


def _add_kinds(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("kinds", nargs="*", metavar="KIND", help="default: all systems")
    _add_axis(parser)


def _add_datasets(commands: Any) -> None:
    text = "list or fetch public recordings of real rigs"
    verbs = _commands(commands.add_parser("datasets", help=text, description=text), dest="verb", metavar="list|prepare")
    _command(verbs, "list", _list_datasets, "list the recordings that can be prepared")
    prepare = _command(verbs, "prepare", _prepare, "fetch a recording, check it and write its dataset folder")
    prepare.add_argument("name", metavar="NAME")
    prepare.add_argument("--source", type=Path, metavar="DIR", help="folder that holds its files already")
    prepare.add_argument("--out", type=Path, metavar="DIR", help="default: ./NAME")


def _add_effect_names(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--effects", nargs="+", default=[], metavar="EFFECT", help="add these, such as joint:stribeck")


def _add_axis(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--axis", choices=("rotary", "linear"), default="rotary", help="units; default: %(default)s")


def _add_progress(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--quiet", action="store_true", help="show no progress")


def _demo(given: Arguments) -> int:
    from tendonlab.cli.demo import demo

    print("The bundled rig: a motor turns a pendulum through an elastic cable; its simulator lacks one effect.\n")
    _print_diagnosis(demo(given.out, progress=not given.quiet), given.out)
    print("Yours: tendonlab diagnose FOLDER --out DIR (the README shows the dataset.toml it needs)")
    return 0


def _check(given: Arguments) -> int:
    from tendonlab.checking.check import check
    from tendonlab.cli.text import check_text
    from tendonlab.data import load

    rig = load(_folder(given.dataset))
    _require_writable(given.out)
    found = check(rig)
    print(check_text(found, rig.warnings))
    if given.out is not None:
        given.out.write_text(json.dumps(found.to_dict(), indent=2, allow_nan=False) + "\n", encoding="utf-8")
        print(f"\nWritten: {given.out}")
    return 0


def _diagnose(given: Arguments) -> int:
    from tendonlab.data import load
    from tendonlab.diagnosis.diagnose import diagnose
    from tendonlab.report.write import prepare_folder

    rig = load(_folder(given.dataset))
    if given.out is not None:
        prepare_folder(given.out)
    settings = {"library": given.library, "seed": given.seed, "force": given.force}
    diagnosis = diagnose(rig, progress=not given.quiet, **settings)
    if given.out is not None:
        diagnosis.report(given.out, figures=not given.no_figures)
    _print_diagnosis(diagnosis, given.out)
    return 0


def _print_diagnosis(diagnosis: Diagnosis, out: Path | None) -> None:
    from tendonlab.cli.diagnosis_text import diagnosis_text

    print(diagnosis_text(diagnosis))
    report = "none written; --out DIR writes one" if out is None else out / "report.html"
    print(f"\n{diagnosis.seconds:.0f} s, seed {diagnosis.seed}. Report: {report}")


def _identify(given: Arguments) -> int:
    from tendonlab.cli.text import identification_text
    from tendonlab.data import load
    from tendonlab.identification.identify import identify

    rig = load(_folder(given.dataset))
    _require_writable(given.out)
    fit = identify(rig, effects=given.effects, num_starts=given.starts, progress=not given.quiet)
    print(identification_text(fit))
    if given.out is not None:
        given.out.write_text(json.dumps(fit.to_dict(), indent=2, allow_nan=False) + "\n", encoding="utf-8")
        print(f"\nWritten: {given.out}")
    return 0


def _simulate(given: Arguments) -> int:
    from tendonlab.cli.text import errors_text, replay_text
    from tendonlab.data import load
    from tendonlab.sweeping.points import refuse_conditions

    rig = load(_folder(given.dataset))
    _require_writable(given.out)
    experiment = _experiment(rig, given.experiment)
    changes = _settings(given.set)
    refuse_conditions(experiment, changes)
    simulator = _changed(rig.system(), given.effects, changes)
    run = simulator.simulate(experiment)
    size = f"{len(experiment.data)} samples, {experiment.duration:g} s"
    print(f"{rig.name}, {experiment.name} ({experiment.split}): {size}\n")
    print(f"{errors_text(run, experiment)}\n\n{replay_text(simulator, experiment)}")
    if given.out is not None:
        run.outputs.to_csv(given.out, index_label="t", float_format="%.9g")
        print(f"\nWritten: {given.out}")
    return 0


def _sweep(given: Arguments) -> int:
    from tendonlab.cli.sweep import grid_from, kept_text, sweep_text, table_from
    from tendonlab.data import load
    from tendonlab.sweeping.sweep import sweep

    rig = load(_folder(given.dataset))
    experiment = _experiment(rig, given.experiment)
    points = table_from(given.points) if given.grid is None else grid_from(given.grid)
    settings = {"reduce": given.reduce, "out": given.out, "progress": not given.quiet}
    swept = sweep(rig.system(), points, experiment=experiment, **settings)
    print(f"{rig.name}, {experiment.name} ({experiment.split})\n\n{sweep_text(swept)}")
    if given.out is not None:
        print(f"\nWritten: {given.out}")
    kept = kept_text(swept, given.out)
    if kept:
        raise KeyboardInterrupt(kept)
    return 0


def _folder(name: str) -> str:
    """The folder of a dataset. Raises DatasetError for the name of a public recording without a folder of that name."""
    from tendonlab.data.datasets import list_datasets

    if name in list_datasets() and not Path(name).exists():
        raise DatasetError(f"{name}: no such folder; `tendonlab datasets prepare {name}` fetches this recording")
    return name


def _require_writable(file: Path | None) -> None:
    """Raise ParameterError, before anything is computed, where a file cannot be written."""
    if file is None:
        return
    if file.is_dir():
        raise ParameterError(f"--out {file}: is a folder; expected the name of a file")
    if not os.access(file if file.exists() else file.parent, os.W_OK):
        raise ParameterError(f"--out {file}: cannot be written; expected a file in an existing folder")


def _experiment(rig: Dataset, name: str | None) -> Experiment:
    return rig[name] if name is not None else [*rig.test, *rig.train][0]


def _settings(texts: Sequence[str]) -> dict[str, float]:
    values = {}
    for text in texts:
        name, equals, value = text.partition("=")
        try:
            values[name] = float(value)
        except ValueError:
            equals = ""
        if not (name and equals):
            raise ParameterError(f"--set {text}: expected NAME=VALUE with a number, such as joint_coulomb=0.05")
    return values


def _changed(system: System, effects: Sequence[str], values: dict[str, float]) -> System:
    """`system` with effects and values. The values of an added effect are set with it: it may have no default."""
    own = {name: {p: values[p] for p in system.info.effect(name).parameters if p in values} for name in effects}
    used = {name for given in own.values() for name in given}
    changed = system.with_effects(own) if own else system
    return changed.with_parameters({name: value for name, value in values.items() if name not in used})


def _effects(given: Arguments) -> int:
    from tendonlab.cli.text import effects_text
    from tendonlab.simulation.catalog import kinds, system_info

    print("\n\n".join(effects_text(system_info(kind), axis=given.axis) for kind in given.kinds or kinds()))
    return 0


def _systems(given: Arguments) -> int:
    from tendonlab.cli.text import system_text
    from tendonlab.simulation.catalog import kinds, system_info

    print("\n\n".join(system_text(system_info(kind), axis=given.axis) for kind in given.kinds or kinds()))
    return 0


def _list_datasets(given: Arguments) -> int:
    from tendonlab.cli.text import wrapped
    from tendonlab.data.datasets import list_datasets
    from tendonlab.report.numbers import counted

    for name, of in list_datasets().items():
        megabytes = sum(file.size for file in of.files) / 1e6
        print(f"{name}  ({counted(len(of.files), 'file')}, {megabytes:.1f} MB)")
        for line in (of.summary, f"Licence: {of.licence}", f"Cite: {of.citation}"):
            print(wrapped(line, indent="    "))
    return 0


def _prepare(given: Arguments) -> int:
    from tendonlab.data.datasets import prepare

    folder = prepare(given.name, source=given.source, out=given.out, progress=sys.stderr.isatty())
    print(f"Ready: {folder}. Next: tendonlab diagnose {folder} --out {folder}-report")
    return 0
