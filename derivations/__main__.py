"""Command line: prove every equation, generate the functions, write the report.

python -m derivations [check [--json] | generate | report [--out DIR]]
"""

import json
import os
import shutil
import signal
import tempfile
import textwrap
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing import Pool
from pathlib import Path
from typing import Any

import click
from tqdm import tqdm

from . import kernel, registry
from .command_line import Commands
from .lecture import to_text

NAME = "python -m derivations"


def _bar(what: str) -> registry.Progress:
    """A progress bar on a terminal, nothing in a pipe."""
    return partial(tqdm, desc=what, disable=None, leave=False)


def table(rows: list[registry.Row]) -> str:
    """Return the proofs as text: tag, what, verdict, note."""
    tag = max(len(row.tag) for row in rows)
    indent = " " * (tag + 2)
    width = max(60, min(shutil.get_terminal_size((100, 24)).columns, 120))
    lines = []
    for row in rows:
        verdict = f"{row.verdict}: NOT PROVED" if row.failed else row.verdict
        lines.append(f"{row.tag:<{tag}}  {verdict:<9}  {to_text(row.what)}")
        remarks = [row.note]
        if row.failed:
            remarks.append(f"this failed: {row.evidence}")
        elif row.verdict == "erratum":
            remarks += [
                row.repair and f"repair: {row.repair}",
                row.mistake and f"mistake: {row.mistake}",
                f"{row.evidence}; contradicted by {', '.join(row.contradicted_by)}",
            ]
        for remark in map(to_text, filter(None, remarks)):
            lines += textwrap.wrap(remark, width, initial_indent=indent, subsequent_indent=indent)
    counts = Counter(row.verdict for row in rows)
    total = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    failed = sum(row.failed for row in rows)
    return "\n".join([*lines, "", f"{len(rows)} entries: {total}; {failed} not proved"])


def _examples(*lines: str) -> str:
    """Epilogue of a help text: commands as they are typed."""
    return "\n".join(["\b", *(f"{NAME} {line}" for line in lines)])


@click.group(
    cls=Commands,
    name=NAME,
    invoke_without_command=True,
    epilog=_examples("check        # so does python -m derivations alone", "report"),
)
@click.version_option(package_name="rod-impact", message="%(package)s %(version)s")
@click.pass_context
def main(context: click.Context) -> int | None:
    """Prove every equation, generate the functions, write the report."""
    return None if context.invoked_subcommand else context.invoke(check)


def _leave_signals() -> None:
    """Signals of the group are for the process that waits for this one, and ends it.

    A pool whose worker has been ended by others may never end.
    """
    os.setpgrp()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


@contextmanager
def _derived() -> Iterator[Any]:
    """Derive all entries while another process proves those of the code, which derive little.

    Yields a pool of two processes that know the derivations, and a function that maps `prove` over
    numbers of entries in them; the proofs of the code come from the other process.
    """
    with Pool(1, _leave_signals) as early:
        code = {
            number: early.apply_async(registry.proved, (number,))
            for number, entry in enumerate(registry.ENTRIES)
            if entry in kernel.CODE
        }
        for entry in _bar("deriving")(registry.ENTRIES):
            with suppress(Exception):  # its proof tells what stops it, if it has a derivation
                entry.derive()
        with Pool(2, _leave_signals) as late:

            def share(prove: Any, numbers: Any) -> Iterator[registry.Row]:
                rest = late.imap(prove, [n for n in numbers if n not in code])
                return (code[n].get() if n in code else next(rest) for n in numbers)

            yield late, share


@main.command(epilog=_examples("check", "check --json"))
@click.option("--json", "as_json", is_flag=True, help="A list of objects instead of a table.")
def check(as_json: bool = False) -> int:
    """Prove every verdict (15 s).

    The exit code is 1 if a proof fails.
    """
    with _derived() as (_, share):
        rows = registry.check(_bar("proving"), share)
    print(json.dumps([row.as_dict() for row in rows], indent=1) if as_json else table(rows))
    return int(any(row.failed for row in rows))


@main.command(epilog=_examples("generate", "generate --language c --out rod_impact.h"))
@click.option(
    "--language",
    type=click.Choice(["c", "javascript", "module", "typescript"]),
    help="Print the impact map as a C99 header, a script or a module, or the types of these two.",
)
@click.option(
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    help="File for it, instead of standard output.",
)
def generate(language: str | None, out: Path | None) -> None:
    """Write the generated functions and tables (10 s).

    They are impact/_generated.py and derivations/EQUATIONS.md of a source checkout. With --language
    neither is written.
    """
    from . import files, languages  # for a quick --help

    if language is None:
        if out is not None:
            raise click.UsageError("--out needs --language")
        root = files.CLOSED_FORMS.parent.parent
        if not (root / "README.md").is_file():
            raise click.UsageError(f"generate needs a source checkout; {root} has no README.md")
        texts = {files.CLOSED_FORMS: files.source(_bar("generating")), files.PAGE: files.page()}
        for path, text in texts.items():
            print(f"{path.name}: {'written' if files.write(text, path) else 'unchanged'}")
    elif out is None:
        print(languages.source(language), end="")
    else:
        if (
            files.plain(out).exists()
            and "derivations generate --language" not in out.read_text(errors="replace")[:500]
        ):
            raise click.UsageError(f"--out must be a new file or a generated one, got {out}")
        written = files.write(languages.source(language), out)
        print(f"{out}: {'written' if written else 'unchanged'}")


@main.command("report", epilog=_examples("report", "report --out pages"))
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default="out",
    help="Folder for report.html.",
)
def write_report(out: Path) -> int:
    """Write the derivation as a page (20 s).

    The exit code is 1 if a proof fails.
    """
    from . import files, report  # for a quick --help

    page = files.plain(out / "report.html")
    if page.exists() and report.TITLE not in page.read_text(errors="replace"):
        raise click.UsageError(f"--out must be a folder without a report.html of yours, got {out}")
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=out), _derived() as (late, share):
        prepared = late.apply_async(report.prepared)
        rows = registry.check(_bar("proving"), share)
        if stuck := [row for row in rows if not row.computed]:
            print(table(stuck), "No report is written: these cannot be computed.", sep="\n")
            return 1
        files.write(report.html(rows, prepared.get(), _bar("writing")), page)
    print(out / "report.html")
    return int(any(row.failed for row in rows))


if __name__ == "__main__":
    main.program()
