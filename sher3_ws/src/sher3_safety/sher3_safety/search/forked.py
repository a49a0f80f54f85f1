"""A call in a fork of this process: it begins with everything as it is here, and leaves everything here as it was."""

from __future__ import annotations

import os
import signal
import traceback
from collections.abc import Callable
from multiprocessing import Pipe
from typing import Any

from sher3_common import Sher3Error

LONGEST = 120
"""Seconds after which a fork ends: threads of the middleware do not live on in it, but what they held stays held."""


class ForkEnded(Sher3Error):
    """A fork that ended without an answer; what it raised stands on the standard error."""


def forked(call: Callable[[], Any]) -> Any:
    """Return what `call` returns in a fork of this process, of whose threads only this one goes on there.

    Raises:
        ForkEnded: it raised an exception, or its process was ended.
    """
    reads, writes = Pipe(duplex=False)
    child = os.fork()
    if not child:
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(LONGEST)
        try:
            writes.send(call())
        except Exception:
            traceback.print_exc()
        finally:
            os._exit(0)
    writes.close()
    try:
        return reads.recv()
    except EOFError:
        raise ForkEnded("a fork ended without an answer", value=child, remedy="see what it printed") from None
    finally:
        reads.close()
        os.waitpid(child, 0)
