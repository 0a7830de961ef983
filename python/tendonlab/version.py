"""The version of tendonlab that runs."""


def version() -> str:
    """As in "1.2.0"; "0.0.0" where the package is used without being installed."""
    from importlib import metadata

    try:
        return metadata.version("tendonlab")
    except metadata.PackageNotFoundError:
        return "0.0.0"
