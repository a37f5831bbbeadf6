"""A worker ends with its server, whatever either of them is at.

The server holds one end of a pipe to which nothing is ever written, and a worker the other. When the server is gone,
also by a kill, the system closes its end. Python could only notice between two of its instructions, and a factorisation
holds it for seconds; so the system is asked to end the process itself. This is called before anything large is
imported.
"""

from __future__ import annotations

import os
import select
import signal

COMMAND = (
    "import sys; from petalfoil.studio.lifeline import end_with, limit_memory; "
    "end_with(int(sys.argv[1])); limit_memory(int(sys.argv[2])); "
    "from petalfoil.studio.worker import main; main()"
)
"""What a worker's process runs; its arguments are the reading end of the pipe, negative where there is none, and the
memory that it may take [bytes]."""


def end_with(lifeline: int) -> None:
    """Let the operating system end this process when the other end of a pipe closes.

    Parameters
    ----------
    lifeline : int
        File descriptor of the reading end; negative on a system without signals of files, where the end of the tasks
        ends the worker (`worker.Inbox`).
    """
    if lifeline < 0:
        return
    import fcntl

    signal.signal(signal.SIGIO, signal.SIG_DFL)  # the default ends the process, whatever Python is at
    fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(lifeline, fcntl.F_SETFL, fcntl.fcntl(lifeline, fcntl.F_GETFL) | os.O_ASYNC)
    if select.select([lifeline], [], [], 0.0)[0]:  # readable: the other end was closed before
        os._exit(0)


def limit_memory(most: int) -> None:
    """Let the operating system refuse this process memory beyond a limit; a request beyond it raises `MemoryError`.

    What counts is what the process may write, and not the libraries that it maps. A system without such limits
    (Windows; macOS takes the limit and ignores it) is left as it is: there the bound of the grid is the only one.

    Parameters
    ----------
    most : int
        Memory that it may take [bytes].
    """
    if os.name == "posix":
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (most, most))
