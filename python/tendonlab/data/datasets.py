"""Public recordings: which there are, and making a dataset folder of one."""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any
from urllib.parse import urlparse
from urllib.request import urlopen

from tendonlab.data.bam import write_bam
from tendonlab.data.emps import write_emps
from tendonlab.errors import DatasetError, ParameterError, expected_one_of

SOURCE_VARIABLE = "TENDONLAB_DATA"
REGISTRY_VARIABLE = "TENDONLAB_REGISTRY"


@dataclass(frozen=True)
class PublicFile:
    """A file of a recording, its size in bytes and its checksum."""

    name: str
    size: int
    sha256: str


@dataclass(frozen=True)
class PublicDataset:
    """A public recording; `home` is the address of the folder that holds its files."""

    name: str
    summary: str
    licence: str
    citation: str
    home: str
    files: tuple[PublicFile, ...]
    write: Callable[[dict[str, Path], Path], None]


_EMPS = PublicDataset(
    name="emps",
    summary="electro-mechanical positioning system: ball-screw axis under cascade control, with disturbance pulses",
    licence="open benchmark; file copies from an Apache-2.0 repository",
    citation="A. Janot, M. Gautier, M. Brunot, Data set and reference models of EMPS, Workshop on Nonlinear System "
    "Identification Benchmarks, Eindhoven, 2019",
    home="https://raw.githubusercontent.com/forgi86/sysid-neural-continuous/"
    "956aa7ecd73061b0321c6f6098d74c9e4a7ce67a/examples/EMPS/data",
    files=(
        PublicFile("DATA_EMPS.mat", 626039, "6cf6814ae14618795da0101aae2bb97ff0c6351b0501b5492751b02b07facf7e"),
        PublicFile("DATA_EMPS_PULSES.mat", 630990, "0eab75bb1f6b16228ee78791343a88bf9bfd9a51036ac9807d7b5fc11c0e1704"),
    ),
    write=write_emps,
)
_BAM = PublicDataset(
    name="bam_xl330",
    summary="pendulum on a small geared servo under its own position control: three gains, four motions",
    licence="Apache-2.0",
    citation="M. Duclusaud, G. Passault, V. Padois, O. Ly, Extended friction models for the physics simulation of "
    "servo actuators, ICRA 2025",
    home="https://raw.githubusercontent.com/Rhoban/bam/af2260462471ff45ac18af159b1327ea51d8db15/bam/data.bak",
    files=(
        PublicFile(
            "processed/2026-01-15_10h28m10.json",
            253563,
            "679215b9bbc50fb95959ce6efe257179e91f1b31ff80df52f8263d9f59ac8204",
        ),
        PublicFile(
            "processed/2026-01-15_10h28m17.json",
            235858,
            "3d0dbbc5508530d7f63249bfcc8f9933c12b8e59909eef9b021038be69219e38",
        ),
        PublicFile(
            "processed/2026-01-15_10h28m24.json",
            247266,
            "1881386668c9dfa66850c7214be2a5d322c92cface018db161f49523b778bed1",
        ),
        PublicFile(
            "processed/2026-01-15_10h28m32.json",
            253558,
            "c34fd5cbbbf915d007afab009ead4dce1f5e29b171aa590967baf13bc69beb0e",
        ),
        PublicFile(
            "processed/2026-01-15_10h29m14.json",
            254687,
            "f283c4136a7215c5a537ad634d20f537e5a336e2af609492bd2d6aade6b50c5e",
        ),
        PublicFile(
            "processed/2026-01-15_10h29m21.json",
            244110,
            "d58d17d74df27283372e198f4bd437628054c8f4e7185a48244545d3fa5063ab",
        ),
        PublicFile(
            "processed/2026-01-15_10h29m29.json",
            239952,
            "e4375867cea77647788f8035a37a9ab356b6b1cebb0aad8c5aeb0336d7510226",
        ),
        PublicFile(
            "processed/2026-01-15_10h29m37.json",
            255544,
            "4e3e1d059424c0530de67919e5e20038631d7145662fd7f69be34ac3efc02b59",
        ),
        PublicFile(
            "processed/2026-01-15_10h29m47.json",
            253193,
            "932064f30186ce745c77dd4c6e25d7b247aea2e496cc33aefe3e884bcda50220",
        ),
        PublicFile(
            "processed/2026-01-15_10h29m54.json",
            239639,
            "d98925d044ad923eccea60eaa03dc5453f985183bf0459f46945b297a707b3d1",
        ),
        PublicFile(
            "processed/2026-01-15_10h30m02.json",
            243113,
            "4fed9230bf6a345216778f23b34bf92a62126c84188d5a7ec5d742d691e1bcce",
        ),
        PublicFile(
            "processed/2026-01-15_10h30m10.json",
            254895,
            "b642f484cc2928b0b782f09cab7bc30b6d6cbff2097f7b96b420a230a355fe62",
        ),
    ),
    write=write_bam,
)
_ALL = {dataset.name: dataset for dataset in (_EMPS, _BAM)}


def list_datasets() -> dict[str, PublicDataset]:
    """The public recordings that `prepare` knows, by name."""
    return dict(_ALL)


def prepare(
    name: str,
    *,
    source: str | PathLike[str] | None = None,
    out: str | PathLike[str] | None = None,
    registry: str | None = None,
    progress: bool = True,
) -> Path:
    """Make the dataset folder `out` (./<name> unless given) of the public recording `name`; returns that folder.

    Its files are looked for in `source`, in the folder that TENDONLAB_DATA names, in the cache, and then downloaded
    from their public home, or from `registry` (or TENDONLAB_REGISTRY), an address that holds them as <name>/<file>.
    Every file is checked against its sha256. Running it again gives the same folder. Raises DatasetError: unknown name,
    files not found or changed, or an `out` whose dataset.toml somebody edited; ParameterError where `out` is a file."""
    dataset = _ALL.get(name)
    if dataset is None:
        raise DatasetError(f"{name!r} is no public dataset; {expected_one_of(name, _ALL)}")
    folder = Path(name) if out is None else Path(out)
    if folder.exists() and not folder.is_dir():
        raise ParameterError(f"out = {str(folder)!r} is a file: expected a folder")
    files = {
        file.name: _find(dataset, file, source=source, registry=registry, progress=progress) for file in dataset.files
    }
    dataset.write(files, folder)
    return folder


def _find(
    dataset: PublicDataset,
    file: PublicFile,
    *,
    source: str | PathLike[str] | None,
    registry: str | None,
    progress: bool,
) -> Path:
    """A verified copy of `file` on this machine."""
    folders = [Path(folder) for folder in (source, os.environ.get(SOURCE_VARIABLE)) if folder]
    places = [place / file.name for folder in folders for place in (folder, folder / dataset.name)]
    for place in places:
        if place.is_file():
            return _verified(place, file)
    return _download(dataset, file, searched=places, registry=registry, progress=progress)


def _verified(path: Path, file: PublicFile) -> Path:
    found = hashlib.sha256(path.read_bytes()).hexdigest()
    if found != file.sha256:
        raise DatasetError(f"{path}: sha256 {found}; expected {file.sha256}, the published file")
    return path


def _download(
    dataset: PublicDataset, file: PublicFile, *, searched: list[Path], registry: str | None, progress: bool
) -> Path:
    import pooch

    base = registry or os.environ.get(REGISTRY_VARIABLE)
    address = f"{base.rstrip('/')}/{dataset.name}/{file.name}" if base else f"{dataset.home}/{file.name}"
    pooch.get_logger().setLevel("WARNING")
    downloader = _copy_file if urlparse(address).scheme == "file" else pooch.HTTPDownloader(progressbar=progress)
    cache = Path(pooch.os_cache("tendonlab")) / dataset.name
    try:
        found: str = pooch.retrieve(
            address,
            known_hash=f"sha256:{file.sha256}",
            fname=Path(file.name).name,
            path=cache,
            downloader=downloader,
        )
    except (OSError, ValueError) as error:  # requests' own errors are OSErrors
        looked = ", ".join(map(str, [*searched, cache]))
        problem = f"not found in {looked}, and the download of {address} failed: {_reason(error, address)}"
        raise DatasetError(f"{file.name}: {problem}; expected its folder as source or {SOURCE_VARIABLE}") from error
    return Path(found)


def _reason(error: Exception, address: str) -> str:
    """Why a download failed. Without a network, requests tells of its sockets and retries in half a page."""
    import requests

    if isinstance(error, requests.ConnectionError | requests.Timeout):
        return f"no connection to {urlparse(address).netloc}"
    return str(error)


def _copy_file(url: str, output_file: Any, pooch: Any) -> None:
    """A downloader for file:// addresses, of which pooch has none; same arguments as pooch's own."""
    with urlopen(url) as response:
        if hasattr(output_file, "write"):
            shutil.copyfileobj(response, output_file)
        else:
            Path(output_file).write_bytes(response.read())
