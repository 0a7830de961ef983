"""`python -m tendonlab.blind draw|run|…`."""

from .commands import main

if __name__ == "__main__":
    raise SystemExit(main())
