"""python -m tendonlab: the same as the command `tendonlab`."""

import sys

from tendonlab.cli import main

sys.exit(main())
