"""python -m tendonlab: the same as the command `tendonlab`."""

import sys

from tendonlab.cli.commands import main

sys.exit(main())
