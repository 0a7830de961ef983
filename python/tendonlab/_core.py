"""Puts the compiled core in the place of this module: the build for the widest vectors that the processor has.

`TENDONLAB_CORE` names the build to take instead: "wide" (AVX-512), "base" (AVX2) or "old" (any x86-64)."""

from __future__ import annotations

import os
import sys
from importlib.machinery import ExtensionFileLoader
from importlib.util import find_spec, module_from_spec, spec_from_loader
from types import ModuleType

BUILDS = ("wide", "base", "old")  # the best first; "old" is in wheels, and where the machine that built it is one


def _load(build: str) -> ModuleType:
    """The build of that name, under the name of this module. ModuleNotFoundError where it was not installed,
    ImportError where the processor lacks its instructions."""
    found = find_spec(f"{__name__}_{build}")
    if found is None or found.origin is None:
        raise ModuleNotFoundError(f"tendonlab was installed without the build {build!r} of its core")
    spec = spec_from_loader(__name__, ExtensionFileLoader(__name__, found.origin))
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _choose() -> ModuleType:
    wanted = os.environ.get("TENDONLAB_CORE")
    if wanted is not None and wanted not in BUILDS:
        raise ImportError(f"TENDONLAB_CORE = {wanted!r}: expected {', '.join(BUILDS[:-1])} or {BUILDS[-1]}")
    return _load(wanted) if wanted is not None else _best()


def _best() -> ModuleType:
    """The first build that was installed and that the processor can run."""
    refused: ImportError | None = None
    for build in BUILDS:
        try:
            return _load(build)
        except ModuleNotFoundError as error:
            refused = refused or error
        except ImportError as error:
            if "needs a processor" not in str(error):  # a broken file is no reason to be slower in silence
                raise
            refused = error
    assert refused is not None
    raise refused


sys.modules[__name__] = _choose()
