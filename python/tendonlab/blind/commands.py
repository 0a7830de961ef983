"""`tendonlab blind draw|run|follow|settled|score|...`: the blind protocol on the command line."""

from __future__ import annotations

import argparse
import json
import shlex
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .rehearsed_commands import add_rehearsed


def add_parser(subparsers: Any) -> None:
    """Add `blind` to the subparsers of the command line; the chosen verb is called as `given.run(given)` and returns
    an exit code.
    """
    text = "check the diagnosis on synthetic rigs whose truth is sealed"
    _add_verbs(subparsers.add_parser("blind", help=text, description=text))


def _add_verbs(parser: argparse.ArgumentParser) -> None:
    def explain(_: argparse.Namespace) -> int:
        parser.print_help()
        return 0

    parser.set_defaults(run=explain)
    verbs = parser.add_subparsers(
        dest="verb", metavar="draw|run|follow|settled|score|tell|results|calibrate|campaign|rehearse|compare"
    )

    drawing = _verb(verbs, "draw", _draw, "draw cases into OUT/cases, their truth apart from them")
    drawing.add_argument("out", type=Path, metavar="OUT")
    drawing.add_argument(
        "--sealed", type=Path, help="new folder of the truth, outside OUT (default OUT/sealed: move it before `run`)"
    )
    _add_drawn(drawing)
    drawing.add_argument("--jobs", type=int, default=2, help="processes (default 2)")

    text = "draw the cases again whose report ends in a tie, each with one more experiment"
    following = _verb(verbs, "follow", _follow, text)
    following.add_argument("reports", type=Path, metavar="REPORTS", help="what `run` wrote of these cases")
    following.add_argument("out", type=Path, metavar="OUT")
    following.add_argument("--sealed", type=Path, required=True, help="new folder of the truth, outside OUT")
    text = "the experiment that the report puts first (default), or a random one of the same length"
    following.add_argument("--choice", choices=("advised", "random"), default="advised", help=text)
    _add_drawn(following)

    text = "diagnose every case, resuming where interrupted, and hash the reports; refused while a truth lies near them"
    running = _verb(verbs, "run", _run, text)
    running.add_argument("cases", type=Path, metavar="CASES")
    running.add_argument("--out", type=Path, required=True, help="folder of the reports and verdicts.json")
    _add_pace(running)

    scoring = _verb(verbs, "score", _score, "open the truth and compare")
    scoring.add_argument("sealed", type=Path, metavar="SEALED")
    scoring.add_argument("reports", type=Path, metavar="REPORTS")
    scoring.add_argument("--csv", type=Path, help="write one row per case here")
    scoring.add_argument("--json", type=Path, help="write summary and cases here")
    _add_settled(verbs)
    _add_tell(verbs)
    _add_results(verbs)
    _add_calibrate(verbs)
    _add_campaign(verbs)
    add_rehearsed(verbs, _verb)


def _add_pace(parser: argparse.ArgumentParser) -> None:
    text = "time limit of one diagnosis; a case that exceeds the limit counts as failed (default 1800)"
    parser.add_argument("--timeout", type=float, default=1800.0, metavar="SECONDS", help=text)
    parser.add_argument("--jobs", type=int, default=1, help="cases at a time (default 1)")


def _add_settled(verbs: Any) -> None:
    text = "open the truth and count the ties that the experiments of `follow` settle"
    parser = _verb(verbs, "settled", _settled, text)
    parser.add_argument("sealed", type=Path, metavar="SEALED")
    parser.add_argument("before", type=Path, metavar="BEFORE", help="reports that `follow` was given")
    parser.add_argument("after", type=Path, metavar="AFTER", help="what `run` wrote of the cases that `follow` drew")
    parser.add_argument("--json", type=Path, help="write counts and ties here; keep them with the truth")


def _add_tell(verbs: Any) -> None:
    text = "open the truth and diagnose the cases again, told which effects are missing: the most that can be reached"
    parser = _verb(verbs, "tell", _tell, text)
    parser.add_argument("sealed", type=Path, metavar="SEALED")
    parser.add_argument("cases", type=Path, metavar="CASES")
    parser.add_argument("--out", type=Path, required=True, help="folder of these reports, apart from those of `run`")
    _add_pace(parser)


def _add_drawn(drawing: argparse.ArgumentParser) -> None:
    """What is drawn: the options that `draw` and `follow` share."""
    drawing.add_argument("--seed", type=int, default=0, help="same seed, same cases (default 0)")
    drawing.add_argument("--count", type=int, default=40, help="number of cases (default 40)")
    text = "draw by a protocol, `standard` or a file; the options below change it"
    drawing.add_argument("--protocol", metavar="NAME", help=text)
    text = "development, calibration or test (default: what the seed serves); seeds that serve another one are refused"
    drawing.add_argument("--purpose", default="", help=text)
    _add_shares(drawing)


def _add_shares(drawing: argparse.ArgumentParser) -> None:
    """Options that are None unless given: the generator, or a protocol, has the defaults."""
    text = "kind of rig, or mixed for all that the protocol draws (default two_inertia)"
    drawing.add_argument("--system", metavar="KIND", help=text)
    text = "share of the cases that repeat an experiment, 0 to 1 (default 1)"
    drawing.add_argument("--repeats", type=float, metavar="SHARE", help=text)
    text = "share of the cases whose cause the library lacks, 0 to 1 (default 0)"
    drawing.add_argument("--unknown", type=float, metavar="SHARE", dest="unknown_share", help=text)
    text = "of the cases that lack an effect, share that lacks a second one, 0 to 1 (default 0)"
    drawing.add_argument("--pairs", type=float, metavar="SHARE", help=text)
    text = "share of the cases whose logs have a mistake: a sign, a unit, a late run, a file twice, 0 to 1 (default 0)"
    drawing.add_argument("--faults", type=float, metavar="SHARE", help=text)
    text = "share of the effects in another form than the library's (default: half of those that have another one)"
    drawing.add_argument("--other-form", type=float, metavar="SHARE", help=text)
    text = "missing effects, as far as the kinds of rigs have them; every rig without unknown cause then lacks one"
    drawing.add_argument("--effects", nargs="+", metavar="EFFECT", help=text)
    text = "rich or poor (default: rich twice as often as poor)"
    drawing.add_argument("--excitation", metavar="KIND", help=text)
    ends = ("LEAST", "LARGEST")
    text = "least and largest gap/noise of an effect (default 1 6)"
    drawing.add_argument("--strengths", type=float, nargs=2, metavar=ends, help=text)
    text = "the same of the second effect of a pair (default: as --strengths)"
    drawing.add_argument("--second", type=float, nargs=2, metavar=ends, help=text)


SERIES: dict[str, Any] = {"type": Path, "nargs": 2, "action": "append", "metavar": ("SEALED", "REPORTS")}


def _add_results(verbs: Any) -> None:
    text = "write the page of results of one series or several: shares, figures and every wrong answer"
    parser = _verb(verbs, "results", _results, text)
    parser.add_argument("--on", required=True, help="diagnosed cases; may be given several times", **SERIES)
    text = "truths of one of these series, and what `tell` wrote; may be given several times"
    parser.add_argument("--told", default=[], help=text, **{**SERIES, "metavar": ("SEALED", "TOLD")})
    text = "calibration.json whose map is shown (default: the shipped one)"
    parser.add_argument("--map", type=Path, metavar="FILE", dest="map_file", help=text)
    parser.add_argument("--out", type=Path, required=True, help="folder of blind-results.md and its figures")


def _results(given: argparse.Namespace) -> int:
    from .results import results
    from .results_page import write

    print(write(results(given.on, given.told, map_file=given.map_file), given.out, _as_called("results")))
    return 0


def _as_called(verb: str) -> str:
    """The command of this process, from the verb on."""
    return f"tendonlab blind {shlex.join(sys.argv[sys.argv.index(verb) :])}"


def _add_calibrate(verbs: Any) -> None:
    text = "fit the map from evidence to probability on diagnosed cases whose truth is open, or test the shipped one"
    parser = _verb(verbs, "calibrate", _calibrate, text)
    text = "cases to fit; may be given several times (default: none, the shipped map stays)"
    parser.add_argument("--on", default=[], help=text, **SERIES)
    parser.add_argument("--test", default=[], help="other cases, which confirm the map or not", **SERIES)
    parser.add_argument("--out", type=Path, required=True, help="file to write, calibration.json")


def _calibrate(given: argparse.Namespace) -> int:
    from .calibrating import calibrate, write_map

    write_map(calibrate(given.on, given.test), given.out)
    print(given.out.read_text(encoding="utf-8"), end="")
    return 0


def _add_campaign(verbs: Any) -> None:
    text = "draw by the protocol, diagnose, fit the map and write the page of results; an interrupted campaign goes on"
    parser = _verb(verbs, "campaign", _campaign, text)
    parser.add_argument("out", type=Path, metavar="OUT", help="folder of cases, reports, calibration.json and the page")
    parser.add_argument("--sealed", type=Path, required=True, help="folder of the truths, outside OUT")
    ends = ("CALIBRATION", "TEST")
    text = "seeds of the series to fit the map on and of the one to test it"
    parser.add_argument("--seeds", type=int, nargs=2, required=True, metavar=ends, help=text)
    text = "number of cases of both series (default 600 300)"
    parser.add_argument("--counts", type=int, nargs=2, metavar=ends, help=text)
    text = "the protocol: `standard` (default) or a file; the options below change it"
    parser.add_argument("--protocol", default="standard", metavar="NAME", help=text)
    text = "diagnose the test series once more, told which effects are missing"
    parser.add_argument("--tell", action="store_true", help=text)
    _add_pace(parser)
    _add_shares(parser)


def _campaign(given: argparse.Namespace) -> int:
    from .campaign import COUNTS, campaign

    asked: dict[str, Any] = {name: getattr(given, name) for name in ("sealed", "protocol", "jobs", "timeout")}
    asked |= {
        "seeds": tuple(given.seeds),
        "counts": tuple(given.counts or COUNTS),
        "tells": given.tell,
        "changed": _shares(given),
    }
    command = _as_called("campaign")
    total = 0.0
    for stage in campaign(given.out, command=command, **asked):
        total += stage.seconds
        print(f"{stage.name}: {stage.seconds:.0f} s{', done before' if stage.was_done else ''}", flush=True)
    print(f"all: {total:.0f} s; wrote {given.out / 'calibration.json'} and {given.out / 'blind-results.md'}")
    return 0


def _verb(verbs: Any, name: str, call: Callable[[argparse.Namespace], int], text: str) -> argparse.ArgumentParser:
    parser: argparse.ArgumentParser = verbs.add_parser(name, help=text, description=text)
    parser.set_defaults(run=call)
    return parser


def _draw(given: argparse.Namespace) -> int:
    from .drawing import draw  # loads numpy and scipy, which `tendonlab --help` does not need

    print(draw(given.seed, given.count, given.out, sealed=given.sealed, jobs=given.jobs, **_drawn(given)))
    return 0


def _follow(given: argparse.Namespace) -> int:
    from .following import follow

    where = {"sealed": given.sealed, "choice": given.choice}
    print(follow(given.seed, given.count, given.reports, given.out, **where, **_drawn(given)))
    return 0


def _drawn(given: argparse.Namespace) -> dict[str, Any]:
    if given.protocol:
        from .protocol import read

        return read(given.protocol).drawn(given.seed, purpose=given.purpose, changed=_shares(given))
    if given.purpose:
        raise ValueError(f"--purpose {given.purpose}: expected a --protocol, which says what its seeds are")
    return _shares(given)


def _shares(given: argparse.Namespace) -> dict[str, Any]:
    """The options of `_add_shares` that were given."""
    shares = ("repeats", "unknown_share", "pairs", "faults", "other_form")
    names = ("system", *shares, "effects", "excitation", "strengths", "second")
    chosen = {name: getattr(given, name) for name in names if getattr(given, name) is not None}
    if "effects" in chosen:
        chosen |= {"effect_share": 1.0, "nothing_share": 0.0}
    return {name: tuple(x) if isinstance(x, list) else x for name, x in chosen.items()}


def _run(given: argparse.Namespace) -> int:
    from .runner import run

    print(run(given.cases, given.out, jobs=given.jobs, timeout=given.timeout))
    return 0


def _tell(given: argparse.Namespace) -> int:
    from .oracle import tell

    print(tell(given.sealed, given.cases, given.out, jobs=given.jobs, timeout=given.timeout))
    return 0


def _score(given: argparse.Namespace) -> int:
    from .scoring import score

    result = score(given.sealed, given.reports)
    print(result)
    if given.csv:
        result.cases.to_csv(given.csv)
    if given.json:
        given.json.write_text(json.dumps(result.to_dict(), indent=1, allow_nan=False) + "\n", encoding="utf-8")
    return 0


def _settled(given: argparse.Namespace) -> int:
    from .ties import settled

    result = settled(given.sealed, given.before, given.after)
    print(result)
    if given.json:
        given.json.write_text(json.dumps(result.to_dict(), indent=1, allow_nan=False) + "\n", encoding="utf-8")
    return 0


def main() -> int:
    """The same without the rest of tendonlab: `python -m tendonlab.blind`."""
    text = "check the diagnosis on synthetic rigs whose truth is sealed"
    parser = argparse.ArgumentParser(prog="python -m tendonlab.blind", description=text)
    _add_verbs(parser)
    given = parser.parse_args()
    try:
        return int(given.run(given))
    except (ValueError, OSError) as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr)
        return 2
