"""The compiled engine, in the build that suits this processor."""

import sys

from flexor._dispatch import load_engine

# The compiled module stands in for this one, whichever build it is.
sys.modules[__name__] = load_engine()
