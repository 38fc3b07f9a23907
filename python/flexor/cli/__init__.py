"""The `flexor` command: a file per sub-command, and one for those that list names."""

import os

# Matrices are small here: the threads of linear algebra would cost more than they do.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
