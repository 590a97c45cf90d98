"""Command line: prove every equation, generate the functions, write the report.

python -m derivations [check [--json] | generate | report [--out DIR]]
"""

import argparse
import json
import os
import shutil
import signal
import sys
import tempfile
import textwrap
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

from tqdm import tqdm

from . import registry

DERIVATIONS = """\
Prove every equation, generate the functions, write the report.

  python -m derivations check        # so does python -m derivations alone
  python -m derivations report
"""

CHECK = """\
Prove every verdict; exit code 1 if a proof fails (10 s).

  python -m derivations check
  python -m derivations check --json
"""

GENERATE = """\
Write impact/_generated.py and the tables of the README, in a checkout (5 s).

  python -m derivations generate
"""

REPORT = """\
Write the derivation as HTML and LaTeX; exit code 1 if a proof fails (15 s).

  python -m derivations report
  python -m derivations report --out pages
"""


def _told(text: str) -> dict[str, Any]:
    """What a command says of itself: one line in the list of commands, all of it in its help."""
    line = text.partition("\n")[0].rstrip(".")
    return {"help": line[0].lower() + line[1:], "description": text}


class _Parser(argparse.ArgumentParser):
    """Help as it is written, never in colours; bad arguments cost one line and exit code 2."""

    def __init__(self, **options: Any):
        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, **options)
        self.color = False  # Python 3.14 would colour a pipe where FORCE_COLOR is set

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}\n")


def _bar(what: str) -> Callable[..., tqdm]:
    """A progress bar on a terminal, nothing in a pipe."""
    return partial(tqdm, desc=what, disable=None, leave=False)


def table(rows: list[registry.Row]) -> str:
    """The proofs as text: tag, what, verdict, note."""
    tag = max(len(row.tag) for row in rows)
    indent = " " * (tag + 2)
    width = max(60, min(shutil.get_terminal_size((100, 24)).columns, 120))
    lines = []
    for row in rows:
        verdict = row.verdict if row.proved else f"{row.verdict}: NOT PROVED"
        lines.append(f"{row.tag:<{tag}}  {verdict:<9}  {row.what}")
        remarks = [row.note]
        if not row.proved:
            remarks.append(f"this failed: {row.evidence}")
        elif row.verdict == "erratum":
            remarks.append(row.evidence)
        for remark in filter(None, remarks):
            lines += textwrap.wrap(remark, width, initial_indent=indent, subsequent_indent=indent)
    counts = Counter(row.verdict for row in rows)
    total = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    failed = sum(not row.proved for row in rows)
    return "\n".join([*lines, "", f"{len(rows)} entries: {total}; {failed} not proved"])


def _check(arguments: argparse.Namespace) -> int:
    rows = registry.check(_bar("proving"))
    if arguments.json:
        print(json.dumps([row.as_dict() for row in rows], indent=1))
    else:
        print(table(rows))
    return 0 if all(row.proved for row in rows) else 1


def _generate(_: argparse.Namespace) -> int:
    from . import codegen, readme

    if not readme.TARGET.is_file():
        print(
            f"python -m derivations generate: generate is for a checkout, and "
            f"{readme.TARGET.parent} is none: there is no {readme.TARGET.name}",
            file=sys.stderr,
        )
        return 2
    changed = codegen.write(codegen.source(_bar("generating")))
    print(f"{codegen.TARGET.name}: {'written' if changed else 'unchanged'}")
    changed = readme.refresh()
    print(f"{readme.TARGET.name}: {'written' if changed else 'unchanged'}")
    return 0


def _report(arguments: argparse.Namespace) -> int:
    arguments.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=arguments.out):  # or it would all be proved for nothing
        pass
    from . import report

    rows = registry.check(_bar("proving"))
    for path in report.write(arguments.out, rows, _bar("writing")):
        print(path)
    return 0 if all(row.proved for row in rows) else 1


def _parser() -> _Parser:
    parser = _Parser(prog="python -m derivations", description=DERIVATIONS)
    commands = parser.add_subparsers(dest="command")
    check = commands.add_parser("check", **_told(CHECK))
    check.add_argument("--json", action="store_true", help="a list of objects instead of a table")
    check.set_defaults(run=_check)
    generate = commands.add_parser("generate", **_told(GENERATE))
    generate.set_defaults(run=_generate)
    report = commands.add_parser("report", **_told(REPORT))
    report.add_argument("--out", type=Path, default=Path("out"), help="folder (default: out)")
    report.set_defaults(run=_report)
    commands.metavar = " | ".join(commands.choices)
    return parser


def main(argv: list[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    words = sys.argv[1:] if argv is None else argv
    arguments = _parser().parse_args(words or ["check"])
    try:
        return arguments.run(arguments)
    except KeyboardInterrupt:
        said, code = "interrupted; nothing half-written was left", 130
    except BrokenPipeError:  # the reader has seen enough
        return 0
    except MemoryError as error:
        said, code = f"not enough memory: {error}", 1
    except OSError as error:
        said, code = f"cannot write: {error}", 2
    print(f"python -m derivations {arguments.command}: {said}", file=sys.stderr)
    return code


def leave(main: Callable[[], int]) -> NoReturn:
    """End the process; output that nobody takes any more is dropped without a traceback."""
    if sys.stdout is None:
        print("python -m derivations: cannot write: standard output is closed", file=sys.stderr)
        sys.exit(2)
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # it is Ctrl-C
    try:
        code = main()
    except SystemExit as end:  # after help, or bad arguments
        code = int(end.code or 0)
    try:
        sys.stdout.flush()
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            print(f"python -m derivations: cannot write: {error}", file=sys.stderr)
            code = code or 2
    sys.exit(code)


if __name__ == "__main__":
    leave(main)
