"""Every command: its help, with examples that hold; what it says and how it exits."""

import argparse
import ast
import importlib
import os
import shlex
import subprocess
import sys
from pathlib import Path

import click
import pytest

import impact

ROOT = Path(impact.__file__).parents[1]
PACKAGES = ("derivations", "figures", "impact", "md")
COMMANDS = {name: importlib.import_module(f"{name}.__main__") for name in PACKAGES}
# Beginnings of examples that take a second at most; the others are read, not run.
CHEAP = ("md impact", "figures list", "md run my_rods --periods")


def parsers(parser):
    """A parser and those of its commands."""
    yield parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for inner in action.choices.values():
                yield from parsers(inner)


def contexts(command, parent=None):
    """A command of click and those in it, each in its context."""
    context = click.Context(command, parent, command.name if parent else "python -m derivations")
    yield context
    for inner in getattr(command, "commands", {}).values():
        yield from contexts(inner, context)


CLICK = ("derivations",)
ALL = {
    p.prog.removeprefix("python -m "): p
    for name, m in COMMANDS.items()
    if name not in CLICK
    for p in parsers(m._parser())
} | {
    c.command_path.removeprefix("python -m "): c
    for name in CLICK
    for c in contexts(COMMANDS[name].cli)
}


def help_of(made):
    """The text of `--help`."""
    return made.format_help() if isinstance(made, argparse.ArgumentParser) else made.get_help()


def words_of(made):
    """Options, arguments and commands, each with what its help says of it."""
    if isinstance(made, click.Context):
        inner = getattr(made.command, "commands", {})
        yield from ((name, c.get_short_help_str(66)) for name, c in inner.items())
        yield from ((option.name, option.help) for option in made.command.get_params(made))
        return
    for action in made._actions:
        inner = isinstance(action, argparse._SubParsersAction)
        said = [(c.metavar, c.help) for c in action._choices_actions] if inner else []
        yield from said or [(action.option_strings or action.dest, action.help)]
        assert not inner or [what for what, _ in said] == list(action.choices)


def examples(text):
    """Indented lines of a help that begin with a command, as the shell would split them."""
    lines = (line for line in text.splitlines() if line.startswith("  python -m "))
    return [shlex.split(line, comments=True) for line in lines]


EXAMPLES = [words[2:] for parser in ALL.values() for words in examples(help_of(parser))]


def exit_code(name, arguments):
    """Of a command, in this process."""
    try:
        return COMMANDS[name].main(arguments)
    except SystemExit as end:
        return end.code


@pytest.mark.parametrize("name", ALL)
def test_help_is_complete(name, capsys, monkeypatch):
    """Each option and command in words, lines that fit, an example of that very command."""
    monkeypatch.setenv("COLUMNS", "80")  # however wide the terminal
    package, *command = name.split()
    assert exit_code(package, [*command, "--help"]) == 0
    printed, err = capsys.readouterr()
    assert err == ""
    assert printed.rstrip() == help_of(ALL[name]).rstrip()
    assert max(map(len, printed.splitlines())) <= 100
    for what, words in words_of(ALL[name]):
        assert words, what
        assert not words.endswith("..."), what
    assert any(words[2 : 3 + len(command)] == name.split() for words in examples(printed))


@pytest.mark.parametrize("words", EXAMPLES, ids=" ".join)
def test_examples_are_commands(words):
    """Each parses, and those that read a scene or a figure name one that is there."""
    package, *arguments = words
    if package in CLICK:
        command, *rest = arguments
        assert COMMANDS[package].cli.commands[command].make_context(command, rest)
        return
    given = ALL[package].parse_args(arguments)
    if "scene" in given and given.scene != "mine.toml":
        assert importlib.import_module("md").load(given.scene, given.set)
    for name in getattr(given, "names", ()):
        assert name in importlib.import_module("figures").FIGURES


@pytest.mark.parametrize("beginning", CHEAP)
def test_cheap_examples_run(beginning, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    cheap = [words for words in EXAMPLES if " ".join(words).startswith(beginning)]
    assert cheap
    for package, *arguments in cheap:
        assert exit_code(package, arguments) == 0
        assert capsys.readouterr().err == ""


@pytest.mark.parametrize("name", ALL)
def test_bad_usage_begins_with_the_command(name, capsys):
    """One line, exit code 2."""
    package, *command = name.split()
    assert exit_code(package, [*command, "--no-such-option"]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert err.startswith((f"python -m {name}: ", f"python -m {package}: unrec"))


REFUSED = {  # what is refused not by the parser: what the one line begins with
    "md run nowhere": "python -m md run: nowhere: no such scene",
    "md impact --tilt-deg 91 --c-x 1 --c-z -1": "python -m md impact: tilt-deg must be",
    "md sweep drift --store no/a.db": "python -m md sweep: store no/a.db: no such folder",
    "md results no.db": "python -m md results: store no.db: no such file",
    "figures draw nothing": "python -m figures draw: there is no figure 'nothing'",
    "figures movie nowhere": "python -m figures movie: nowhere: no such scene",
    "figures movie quasi2d --out a.png": "python -m figures movie: out must be a folder",
    "figures index --out FILE": "python -m figures index: out must be a folder that holds",
    "derivations report --out FILE": "python -m derivations report: Invalid value for '--out'",
}


@pytest.mark.parametrize("command", REFUSED)
def test_refusals_begin_with_the_command(command, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("FILE").touch()
    package, *arguments = command.split()
    assert exit_code(package, arguments) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert err.startswith(REFUSED[command])


ENDS = [(KeyboardInterrupt, 130, "interrupted"), (MemoryError, 1, "not enough memory")]
DONE = {  # a command, and the function that does its work
    "derivations check": "derivations.registry.check",
    "figures index": "figures.pages.index.files",
    "impact benchmark": "impact.__main__.benchmark",
    "md run single_rod": "md.accuracy.run",
}


@pytest.mark.parametrize(("error", "code", "said"), ENDS)
@pytest.mark.parametrize("command", DONE)
def test_ends_before_the_time(command, error, code, said, capsys, tmp_path, monkeypatch):
    """Ctrl-C is 130, what fails is 1; one line, that begins with the command."""

    def work(*_arguments, **_options):
        raise error

    monkeypatch.chdir(tmp_path)
    importlib.import_module(DONE[command].rpartition(".")[0].removesuffix(".__main__"))
    monkeypatch.setattr(DONE[command], work)
    package, *arguments = command.split()
    assert exit_code(package, arguments) == code
    _, err = capsys.readouterr()
    assert err.count("\n") == 1
    assert err.startswith(f"python -m {package} {arguments[0]}: {said}")


@pytest.mark.parametrize("package", PACKAGES)
def test_help_in_a_pipe_is_plain(package):
    """Even where colours are asked for; a reader that leaves at once is no error."""
    command = [sys.executable, "-m", package, "--help"]
    environment = {**os.environ, "FORCE_COLOR": "1", "PYTHONUNBUFFERED": ""}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    assert "\x1b" not in done.stdout + done.stderr
    assert "python -m" in done.stdout
    reader, writer = os.pipe()
    os.close(reader)
    gone = subprocess.run(
        command, stdout=writer, stderr=subprocess.PIPE, text=True, env=environment, check=False
    )
    os.close(writer)
    assert (gone.returncode, gone.stderr) == (0, "")


@pytest.mark.parametrize("name", [n for n, made in ALL.items() if hasattr(made, "format_help")])
def test_no_parser_colours(name):
    """Python 3.14's would, where FORCE_COLOR is set, whether or not somebody looks."""
    assert getattr(ALL[name], "color", True) is False


def bars():
    """Calls that make a progress bar, with their file."""
    for file in sorted(f for package in PACKAGES for f in (ROOT / package).rglob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call):
                made = node.args[:1] if ast.unparse(node.func) == "partial" else [node.func]
                if [ast.unparse(part) for part in made] == ["tqdm"]:
                    yield f"{file.relative_to(ROOT)}:{node.lineno}", node


BARS = dict(bars())


@pytest.mark.parametrize("where", BARS)
def test_progress_bars_are_for_terminals(where):
    """`disable=None` is tqdm's word for that; a caller may ask for none at all."""
    given = {option.arg: ast.unparse(option.value) for option in BARS[where].keywords}
    assert given.get("disable") in ("None", "None if progress else True")
