"""How fast tendonlab is beside other tools at the same error: `python tests/benchmarks --help`."""
