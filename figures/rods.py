"""`rods md run my_rods`, the same as `python -m md run my_rods`: all commands under one name."""

import os
import sys

COMMANDS = {
    "impact": "the theory: time of one impact",
    "md": "one impact, a scene, a sweep, a search",
    "figures": "figures, movie, claims, prices, a page of sliders",
    "derivations": "check, generate, report",
}


def main() -> None:
    """Run a package's command in the place of this process."""
    name, *rest = sys.argv[1:] or [""]
    if name in COMMANDS:
        os.execv(sys.executable, [sys.executable, "-m", name, *rest])
    lines = (f"  rods {command:12} {what}" for command, what in COMMANDS.items())
    print("\n".join(["Rods on a vibrated plate; each has a --help of its own:", *lines]))
    if name not in ("", "--help"):
        sys.exit(f"rods: no command {name!r}")
