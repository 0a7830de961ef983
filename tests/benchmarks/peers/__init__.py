"""The tools that tendonlab is compared with. None is a dependency of it."""
