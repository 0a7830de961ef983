"""The verbs `rehearse` and `compare` on the command line."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any


def add_rehearsed(verbs: Any, verb: Callable[..., argparse.ArgumentParser]) -> None:
    """Add both verbs; `verb` adds one, of a name, with what it calls and its help."""
    text = "rehearse drawn rigs that lack nothing, then record and diagnose the same rigs with effects missing; resumes"
    rehearsing = verb(verbs, "rehearse", _rehearse, text)
    rehearsing.add_argument("out", type=Path, metavar="OUT", help="a folder for each design")
    rehearsing.add_argument("--sealed", type=Path, required=True, help="folder of the truths, outside OUT")
    _add_designs(rehearsing)
    rehearsing.add_argument("--count", type=int, default=10, help="number of designs (default 10)")
    text = "time of one rehearsal at most (default 120)"
    rehearsing.add_argument("--minutes", type=float, default=120.0, metavar="M", help=text)
    text = "time limit of one diagnosis of a realised rig (default 1800)"
    rehearsing.add_argument("--timeout", type=float, default=1800.0, metavar="SECONDS", help=text)

    comparing = verb(verbs, "compare", _compare, "open the truth: predicted detection rates beside realised ones")
    text = "truths and designs of `rehearse`; may be given several times"
    ends = ("SEALED", "OUT")
    comparing.add_argument("--on", required=True, type=Path, nargs=2, action="append", metavar=ends, help=text)
    comparing.add_argument("--json", type=Path, help="write tables and cases here; they tell the truth")


def _add_designs(parser: argparse.ArgumentParser) -> None:
    """What is drawn and asked: the fields of `Designs`."""
    parser.add_argument("--seed", type=int, default=0, help="same seed, same designs (default 0)")
    parser.add_argument("--system", default="rigid_joint", metavar="KIND", help="kind of rig (default rigid_joint)")
    text = "share of the designs that repeat an experiment, 0 to 1 (default 0.5)"
    parser.add_argument("--repeats", type=float, default=0.5, metavar="SHARE", help=text)
    text = "highest sample rate (default 1000)"
    parser.add_argument("--fastest", type=float, default=1000.0, metavar="HZ", help=text)
    text = "effects of a design, drawn from those that can be compared (default 4)"
    parser.add_argument("--effects", type=int, default=4, metavar="N", dest="num_effects", help=text)
    text = "gaps over noise, as a rehearsal has them (default 0.1 0.3 1 3)"
    parser.add_argument("--sizes", type=float, nargs="+", default=(0.1, 0.3, 1.0, 3.0), metavar="GAP", help=text)
    text = "rigs of each effect and size in the rehearsal (default 6)"
    parser.add_argument("--rehearsed", type=int, default=6, metavar="N", help=text)
    text = "rigs of each effect and size that the generator records (default 1)"
    parser.add_argument("--realised", type=int, default=1, metavar="N", help=text)


def _rehearse(given: argparse.Namespace) -> int:
    from .rehearsing import Designs, rehearse

    names = ("seed", "system", "repeats", "fastest", "num_effects", "rehearsed", "realised")
    designs = Designs(sizes=tuple(given.sizes), **{name: getattr(given, name) for name in names})
    where = {"sealed": given.sealed, "minutes": given.minutes, "timeout": given.timeout}
    print(rehearse(designs, given.count, given.out, **where))
    return 0


def _compare(given: argparse.Namespace) -> int:
    from .comparing import compare

    result = compare([(sealed, out) for sealed, out in given.on])
    print(result)
    if given.json:
        given.json.write_text(json.dumps(result.to_dict(), indent=1, allow_nan=False) + "\n", encoding="utf-8")
    return 0
