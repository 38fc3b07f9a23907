"""An interruption (Ctrl-C) that reaches the command wherever it arrives."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_AGAIN = 0.05  # seconds, by when the finaliser that ignored the interruption has ended


def _interrupt() -> None:
    if hasattr(signal, "pthread_kill"):
        # Unlike interrupt_main, ends a system call that waits.
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
    else:
        _thread.interrupt_main()


@contextmanager
def interruptions_not_ignored() -> Iterator[None]:
    """Interrupt the main thread again where Python ignores an interruption.

    Python ignores exceptions in finalisers and in callbacks of the garbage collector (some
    libraries have such callbacks), among them the KeyboardInterrupt of a signal that arrives there.
    """
    before = sys.unraisablehook

    def hook(ignored: Any) -> None:
        if not issubclass(ignored.exc_type, KeyboardInterrupt):
            before(ignored)
            return
        again = threading.Timer(_AGAIN, _interrupt)
        again.daemon = True
        again.start()

    sys.unraisablehook = hook
    try:
        yield
    finally:
        sys.unraisablehook = before
