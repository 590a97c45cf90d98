"""Command line: prove every equation, generate the functions, write the report.

python -m derivations [check [--json] | generate | report [--out DIR] | mutate]
"""

import json
import shutil
import tempfile
import textwrap
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path

import click
from tqdm import tqdm

from . import registry
from .command_line import Commands
from .sentences import to_text

NAME = "python -m derivations"
_FILE = click.Path(dir_okay=False, path_type=Path)


def _bar(what: str) -> Callable[..., tqdm]:
    """A progress bar on a terminal, nothing in a pipe."""
    return partial(tqdm, desc=what, disable=None, leave=False)


def table(rows: list[registry.Row]) -> str:
    """Return the proofs as text: tag, what, verdict, note."""
    tag = max(len(row.tag) for row in rows)
    indent = " " * (tag + 2)
    width = max(60, min(shutil.get_terminal_size((100, 24)).columns, 120))
    lines = []
    for row in rows:
        verdict = row.verdict if row.proved else f"{row.verdict}: NOT PROVED"
        lines.append(f"{row.tag:<{tag}}  {verdict:<9}  {to_text(row.what)}")
        remarks = [row.note]
        if not row.proved:
            remarks.append(f"this failed: {row.evidence}")
        elif row.verdict == "erratum":
            remarks.append(row.repair and f"repair: {row.repair}")
            remarks.append(row.mistake and f"mistake: {row.mistake}")
            remarks.append(f"{row.evidence}; contradicted by {row.contradicted_by}")
        for remark in map(to_text, filter(None, remarks)):
            lines += textwrap.wrap(remark, width, initial_indent=indent, subsequent_indent=indent)
    counts = Counter(row.verdict for row in rows)
    total = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
    failed = sum(not row.proved for row in rows)
    return "\n".join([*lines, "", f"{len(rows)} entries: {total}; {failed} not proved"])


def _code(rows: list[registry.Row]) -> int:
    return 0 if all(row.proved for row in rows) else 1


def _examples(*lines: str) -> str:
    """Epilogue of a help text: commands as they are typed."""
    return "\n".join(["\b", *(f"{NAME} {line}".rstrip() for line in lines)])


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


@main.command(epilog=_examples("check", "check --json"))
@click.option("--json", "as_json", is_flag=True, help="A list of objects instead of a table.")
def check(as_json: bool = False) -> int:
    """Prove every verdict (10 s).

    The exit code is 1 if a proof fails.
    """
    rows = registry.check(_bar("proving"))
    print(json.dumps([row.as_dict() for row in rows], indent=1) if as_json else table(rows))
    return _code(rows)


@main.command(epilog=_examples("generate", "generate --language c --out rod_impact.h"))
@click.option(
    "--language",
    type=click.Choice(["c", "javascript"]),
    help="Print the impact map as a C99 header or as a script.",
)
@click.option("--out", type=_FILE, help="File for it, instead of standard output.")
def generate(language: str | None, out: Path | None) -> int:
    """Write the generated functions and tables (5 s).

    They are impact/_generated.py, impact/_kernel.py and derivations/EQUATIONS.md of a source
    checkout. With --language nothing of these is written.
    """
    from . import equations_page, files, languages  # for a quick --help

    if language is not None:
        text = languages.source(language)
        if out is None:
            print(text, end="")
        else:
            print(f"{out}: {'written' if files.write(text, out) else 'unchanged'}")
        return 0
    if out is not None:
        raise click.UsageError("--out needs --language")
    root = files.KERNEL.parent.parent
    if not (root / "README.md").is_file():
        raise click.UsageError(f"generate needs a source checkout; {root} has no README.md")
    texts = files.sources(_bar("generating"))
    changed = {path: files.write(text, path) for path, text in texts.items()}
    changed[equations_page.TARGET] = equations_page.refresh()
    for path, written in changed.items():
        print(f"{path.name}: {'written' if written else 'unchanged'}")
    return 0


@main.command(epilog=_examples("mutate"))
def mutate() -> int:
    """Try the proofs on deliberate mistakes (2 min).

    What kept its verdict is listed, and what says the same as before; the counts are recorded for
    the report. The exit code is 1 if a mistake kept its verdict.
    """
    from . import mutants  # for a quick --help

    found = mutants.run(_bar("trying"))
    for mutant in found:
        if mutant.outcome != "caught":
            print(f"{mutant.tag}, {mutant.side}: {mutant.change}: {mutant.outcome}")
    print(mutants.recorded())
    return int(any(mutant.outcome == "survived" for mutant in found))


@main.command("report", epilog=_examples("report", "report --out pages"))
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default="out",
    help="Folder for report.html and latex/*.tex.",
)
def write_report(out: Path) -> int:
    """Write the derivation as HTML and LaTeX (20 s).

    The exit code is 1 if a proof fails.
    """
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=out):  # refused before all is proved
        pass
    from . import report  # for a quick --help

    rows = registry.check(_bar("proving"))
    if stuck := [row for row in rows if not row.computed]:
        print(table(stuck), "No report is written: these cannot be computed.", sep="\n")
        return 1
    for path in report.write(out, rows, _bar("writing")):
        print(path)
    return _code(rows)


if __name__ == "__main__":
    main.program()
