"""Command line: prove every equation, generate the functions, write the report.

python -m derivations [check [--json] | generate | report [--out DIR]]
"""

import argparse
import json
import os
import shutil
import sys
import textwrap
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NoReturn

from tqdm import tqdm

from . import registry


class _Parser(argparse.ArgumentParser):
    """Bad arguments cost one line on stderr and exit code 2."""

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
            f"derivations: generate is for a checkout, and {readme.TARGET.parent} is none: "
            f"there is no {readme.TARGET.name}",
            file=sys.stderr,
        )
        return 2
    changed = codegen.write(codegen.source(_bar("generating")))
    print(f"{codegen.TARGET.name}: {'written' if changed else 'unchanged'}")
    changed = readme.refresh()
    print(f"{readme.TARGET.name}: {'written' if changed else 'unchanged'}")
    return 0


def _report(arguments: argparse.Namespace) -> int:
    from . import report

    rows = registry.check(_bar("proving"))
    for path in report.write(arguments.out, rows, _bar("writing")):
        print(path)
    return 0 if all(row.proved for row in rows) else 1


def main(argv: list[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    parser = _Parser(prog="python -m derivations", description=__doc__)
    commands = parser.add_subparsers(dest="command")
    check = commands.add_parser("check", help="prove every verdict (the default)")
    check.add_argument("--json", action="store_true", help="a list of objects instead of a table")
    check.set_defaults(run=_check)
    generate = commands.add_parser("generate", help="write impact/_generated.py")
    generate.set_defaults(run=_generate)
    report = commands.add_parser("report", help="write the derivation as HTML and LaTeX")
    report.add_argument("--out", type=Path, default=Path("out"), help="folder (default: out)")
    report.set_defaults(run=_report)
    arguments = parser.parse_args(argv or ["check"])
    try:
        return arguments.run(arguments)
    except KeyboardInterrupt:
        print("interrupted; nothing half-written was left", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader has seen enough
        return 0
    except OSError as error:
        print(f"derivations: cannot write: {error}", file=sys.stderr)
        return 2


def leave(code: int) -> None:
    """End the process; output that nobody takes any more is dropped without a traceback."""
    try:
        sys.stdout.flush()
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            print(f"cannot write: {error}", file=sys.stderr)
            code = code or 2
    sys.exit(code)


if __name__ == "__main__":
    leave(main(sys.argv[1:]))
