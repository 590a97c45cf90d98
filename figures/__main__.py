"""Command line of the figures: `python -m figures --help`.

What is heavy is imported within the commands: help and list need no Numba and no Matplotlib.
"""

import json
import os
from math import isfinite
from pathlib import Path
from time import perf_counter
from typing import Any

import click

from derivations.command_line import Commands
from impact import InputError

from . import FIGURES, check
from .lib.printing import plain, printed

PRICES = "prices.txt", "prices.json", "prices.png"
CLAIMS, PAGES = ("claims.json", "claims.md"), ("impact.html", "index.html")


def _write_text(path: Path, text: str) -> None:
    from md.files import replacing

    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")


def _json_text(content: Any) -> str:
    return json.dumps(plain(content), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _path(name: str, what: str, default: str | None = None, metavar: str = "FILE") -> Any:
    """An option whose value is a path."""
    return click.option(
        name, type=click.Path(path_type=Path), default=default, metavar=metavar, help=what
    )


def _number(name: str, what: str, metavar: str | None = None) -> Any:
    """An option whose value is a number."""
    return click.option(name, type=float, metavar=metavar, help=what)


_out = _path("--out", "Folder.", "out", "DIR")
_store = _path("--store", "SQLite file of the runs (default rows.db in --out).")
_quick = click.option("--quick", is_flag=True, help="Coarse grids, short runs, for a first look.")


@click.group(cls=Commands, name="python -m figures", no_args_is_help=False)
@click.version_option(package_name="rod-impact", message="%(package)s %(version)s")
def main() -> None:
    """List and draw the figures, animate a scene, judge the claims, show all of it.

    \b
    python -m figures draw fig11
    python -m figures movie quasi2d --periods 4
    """


@main.command("list")
def list_figures() -> None:
    """List the figures: names, titles, which ones are in the quick set.

    \b
    python -m figures list
    """
    width = max(map(len, FIGURES))
    for name, entry in FIGURES.items():
        own = f" (--{', --'.join(entry.own)})" if entry.own else ""
        print(f"{name:<{width}}  {'quick' if entry.quick else '     '}  {entry.title}{own}")


@main.command()
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--all", "every", is_flag=True, help="Every figure.")
@_quick
@click.option(
    "--jobs",
    type=click.IntRange(1, 1000),
    default=os.cpu_count(),
    metavar="N",
    help="Processes; figures that take all cores or measure times come last, one at a time.",
)
@_path("--data", "Draw what a folder holds as NAME.npz; compute nothing.", metavar="DIR")
@click.option("--numbers", is_flag=True, help="Print the numbers of each figure as tables.")
@_number("--friction", "In place of the paper's.", "MU")
@_number("--restitution", "In place of the paper's.", "E")
@_number("--length", "In diameters, in place of the paper's.", "L")
@click.option("--scene", metavar="SCENE", help="Rods of your own, in place of the paper's.")
@_out
@_store
def draw(
    names: tuple[str, ...],
    every: bool,
    quick: bool,
    jobs: int,
    data: Path | None,
    numbers: bool,
    out: Path,
    store: Path | None,
    **given: Any,
) -> None:
    """Compute and draw figures; without names: a first look.

    NAME is one of python -m figures list. Without names the quick set is drawn, on coarse grids. A
    figure that fails leaves the others as they are. Figures of the theory take values of your own,
    figures of a row or an annulus over its tilt a scene: list says which.

    \b
    python -m figures draw fig10 fig11 --out pictures
    python -m figures draw --all --quick            # every figure, on coarse grids
    python -m figures draw fig10 --numbers
    python -m figures draw fig10 fig11 --friction 0.2 --restitution 0.5
    python -m figures draw fig06 fig08 --scene my_rods --quick
    """
    check(names)
    own = {key: value for key, value in given.items() if value is not None}
    for key, value in own.items():
        if isinstance(value, float) and not (value >= 0 if key == "friction" else isfinite(value)):
            domain = "a number >= 0" if key == "friction" else "finite"
            raise InputError(f"{key} must be {domain}, got {value:g}")
        takes = [name for name, entry in FIGURES.items() if key in entry.own]
        if not names or {*names} - {*takes}:
            raise InputError(f"{key} is for the figures {', '.join(takes)}; name them alone")
    if every and names:
        raise InputError(f"--all draws every figure and takes no names, got {names[0]}")
    if data:
        for key in (*own, *(key for key, value in (("quick", quick), ("store", store)) if value)):
            raise InputError(f"{key} has no meaning with --data, which computes nothing")
        for name in names:
            if not (data / f"{name}.npz").is_file():
                raise InputError(f"--data must be a folder that holds {name}.npz, got {data}")
    quick_set = [name for name, entry in FIGURES.items() if entry.quick]
    wanted = list(FIGURES) if every else list(dict.fromkeys(names)) or quick_set
    quick = quick or not (every or names)

    from .lib.drawing import draw_all, files_of
    from .lib.files import storing

    with storing(out, store, *files_of(*wanted)):
        failed = draw_all(wanted, out, quick, jobs, data, numbers, own)
    if failed:
        kind = InputError if min(failed.values()) == InputError.exit_code else click.ClickException
        raise kind(f"{len(failed)} of {len(wanted)} failed: {', '.join(failed)}")


@main.command()
@click.argument("scene")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="Change a key.")
@click.option("--periods", type=int, default=20, help="Of the plate.")
@click.option("--frames", type=int, default=8, help="A period.")
@_path("--out", "Folder, or a file that ends in .gif.", "out", "DIR|FILE.gif")
def movie(scene: str, changes: tuple[str, ...], periods: int, frames: int, out: Path) -> None:
    """Animate a scene: a GIF that repeats.

    SCENE is a TOML file, or the name of an example.

    \b
    python -m figures movie quasi2d --periods 4
    python -m figures movie my_rods --set plate.amplitude_cm=0.03 --out row.gif
    """
    import md
    from md.files import replacing

    from .lib.files import ready
    from .pages import movie as movies

    name = f"{Path(scene).stem}.gif"
    if out.suffix == ".gif":
        name, out = out.name, out.parent
    elif out.suffix and not out.is_dir():
        raise InputError(f"out must be a folder or a file that ends in .gif, got {out}")
    loaded = md.load(scene, changes)
    (path,) = ready(out, name)
    film = movies.record(loaded, periods, frames, progress=True)
    with replacing(path) as part:
        movies.write(film, part, progress=True)
    print(f"{path}  {film.pictures} frames")


@main.command()
@click.option("--scene", metavar="SCENE", help="Judge the statements on a row for these rods.")
@_quick
@_out
@_store
def claims(scene: str | None, quick: bool, out: Path, store: Path | None) -> None:
    """Judge what the paper claims: claims.json, claims.md.

    With --scene, a TOML file or the name of an example: what it says of a row over its tilt, for
    rods of your own; claims-SCENE.json.

    \b
    python -m figures claims --quick                # short runs, for a first look
    python -m figures claims
    python -m figures claims --scene my_rods
    """
    from .claims import judge
    from .lib.files import storing
    from .pages import gallery

    if scene is not None:
        from .claims import own_rods

        name = f"claims-{Path(scene).stem}.json"
        with storing(out, store, name):
            for words in own_rods.estimate(scene, quick):
                print(words, flush=True)
            found = own_rods.judged(scene, quick)
        _write_text(out / name, _json_text(found))
        print(f"{own_rods.brief(found)}\n{out / name}")
        return
    with storing(out, store, *CLAIMS):
        report = judge.judge(quick, out)
    numbers, page = (out / name for name in CLAIMS)
    _write_text(numbers, _json_text(report))
    _write_text(page, gallery.claims_page(report))
    print(judge.brief(report))


@main.command()
@click.option("--estimate", is_flag=True, help="Say how long it takes, no more.")
@_out
@_store
def paper(estimate: bool, out: Path, store: Path | None) -> int:
    """Make all in full: the figures, the movie, the claims, the page.

    The same command goes on where it stopped.

    \b
    python -m figures paper --estimate
    python -m figures paper
    """
    from .lib.drawing import files_of
    from .lib.files import storing
    from .pages import everything

    begin = perf_counter()
    made = *files_of(*FIGURES), "quasi2d.gif", *CLAIMS, *PAGES
    with storing(out, store, *made):
        print(everything.estimate(out), flush=True)
        names = everything.left(out)
    if estimate:
        return 0
    where, runs = ["--out", str(out)], ["--store", str(store or out / "rows.db")]
    commands = [["draw", *names, *runs]] if names else []
    commands += [["movie", "quasi2d", "--periods", "4"], ["claims", *runs], ["index"]]
    codes = (main([*command, *where]) for command in commands)
    code = next(filter(None, codes), 0)
    print(f"took {everything.in_words(perf_counter() - begin)}")
    return code


@main.command()
@_out
@_store
def prices(out: Path, store: Path | None) -> None:
    """Measure all prices on this machine, quickly: ten minutes.

    What the folder holds of them in full, by the present sources, is taken as it is.

    \b
    python -m figures prices
    """
    import matplotlib.pyplot as plt

    from md.files import replacing

    from .cost import price_page
    from .lib.data import stored_data
    from .lib.drawing import files_of, produce
    from .lib.files import storing
    from .lib.timing import waited

    found: dict[str, Any] = {}
    names = [*price_page.PRICE_PANELS]
    bar = waited(names, "prices", "figure")
    with storing(out, store, *files_of(*names), *PRICES):
        for name in bar:
            bar.set_postfix_str(name)
            found[name] = stored_data(name, False, out)
            if found[name] is None:
                bar.write(produce(name, out, quick=True).files)
                found[name] = stored_data(name, True, out)
    words = "\n\n".join(f"{FIGURES[name].title}\n{printed(d)}" for name, d in found.items())
    picture = price_page.draw(found)
    text, numbers, png = (out / name for name in PRICES)
    _write_text(text, words + "\n")
    _write_text(numbers, _json_text(price_page.numbers(found)))
    with replacing(png) as part:
        picture.savefig(part, dpi=200)
    plt.close(picture)
    print(f"{words}\n\n{text}  {png.name}")


@main.command()
@_out
def index(out: Path) -> None:
    """Write one page of all that the folder holds: index.html.

    \b
    python -m figures index
    python -m figures index --out pictures
    """
    from md.files import replacing

    from .lib.files import ready
    from .pages import index as page

    files = page.files(out)
    ready(out, *files)
    for name, content in files.items():
        with replacing(out / name) as part:
            part.write_bytes(content)
    print(out / PAGES[-1])


@main.command()
def pages() -> None:
    """Write the pages of the gallery and the README's numbers.

    \b
    python -m figures pages
    """
    from .pages import gallery

    if not gallery.README.is_file():
        raise InputError(f"it needs a source checkout; there is no {gallery.README}")
    for path, text in gallery.pages().items():
        old = path.is_file() and path.read_text(encoding="utf-8") == text
        if not old:
            _write_text(path, text)
        print(f"{path}  {'as it was' if old else 'written'}")


@main.command()
@_number("--tilt-deg", "0 to 90 (default 30).", "PHI")
@_number("--friction", "0 to 1 (default 0.3).", "MU")
@_number("--restitution", "0 to 1 (default 0.65).", "E")
@_number("--ratio", "-c_z/c_x before, 0.1 to 10 (default 2).")
@_number("--spin", "k omega before, -2 to 2 (default 0).")
@_number("--length", "In diameters, 1 to 20 (default 8).")
@click.option("--shape", help="thin, round (default) or flat.")
@click.option("--law", help="newton (default), poisson or stronge.")
@_path("--html", "Page to write.", "out/impact.html", "FILE.html")
def explore(html: Path, **given: Any) -> None:
    """Write a page of sliders: one impact as it goes on, and the drift.

    \b
    python -m figures explore
    python -m figures explore --tilt-deg 40 --friction 0.5 --html setting.html
    """
    from .lib.files import ready
    from .pages import explore as moving

    start = {name: value for name, value in given.items() if value is not None}
    if html.suffix != ".html":
        raise InputError(f"html must be a file that ends in .html, got {html}")
    ready(html.parent, html.name, option="html")
    _write_text(html, moving.page(moving.Setting(**start)))
    print(html)


if __name__ == "__main__":
    main.program()  # `md.run` would return half of a run to a figure, if it took Ctrl-C over
