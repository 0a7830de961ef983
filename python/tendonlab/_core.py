"""Puts the compiled core in the place of this module: the build for the widest vectors that the processor has.

`TENDONLAB_CORE` names the build to take instead: "wide" (AVX-512) or "base"."""

from __future__ import annotations

import os
import sys
from importlib.machinery import ExtensionFileLoader
from importlib.util import find_spec, module_from_spec, spec_from_loader
from types import ModuleType

BUILDS = ("wide", "base")  # the best first


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
    if wanted is None:
        try:
            return _load(BUILDS[0])
        except ModuleNotFoundError:
            return _load(BUILDS[-1])
        except ImportError as error:  # a broken file is no reason to be slower in silence
            if "needs a processor" not in str(error):
                raise
            return _load(BUILDS[-1])
    if wanted not in BUILDS:
        raise ImportError(f"TENDONLAB_CORE = {wanted!r}: expected {' or '.join(BUILDS)}")
    return _load(wanted)


sys.modules[__name__] = _choose()
