"""python tests/benchmarks [jobs]: see `benchmarks.command`."""

import os
import sys
from pathlib import Path

# Before numpy is loaded: one thread per library, so that CPU times compare.
for library in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[library] = "1"
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
sys.path[0] = str(Path(__file__).resolve().parents[1])

if __name__ == "__main__":
    from benchmarks.command import main

    main()
