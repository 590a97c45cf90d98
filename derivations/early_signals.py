"""Ctrl-C while a command is being imported: it ends at once, as nothing was begun.

The first import of each package with commands; SIGTERM ends it likewise by itself. The same file
stands in `derivations`, `figures` and `md`.
"""

import signal
import sys

_of_command = sys.argv[:1] == ["-m"]  # Python imports the package of a command
if _of_command and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
    signal.signal(signal.SIGINT, signal.SIG_DFL)
