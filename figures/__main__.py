"""Command line: list and draw the figures, animate a scene, judge the claims, show all of it.

python -m figures list
python -m figures draw [NAME ... | --all] [--quick] [--out DIR] [--store FILE]
python -m figures movie SCENE [--set KEY=VALUE ...] [--periods N] [--frames F] [--out DIR|FILE.gif]
python -m figures claims [--quick] [--out DIR] [--store FILE]
python -m figures paper [--estimate] [--out DIR] [--store FILE]
python -m figures prices [--out DIR] [--store FILE]
python -m figures index [--out DIR]
python -m figures readme
python -m figures explore [--tilt-deg PHI] [--friction MU] ... [--out FILE.png]
"""

import argparse
import json
from contextlib import AbstractContextManager
from pathlib import Path

from impact._command import CommandError, Parser, guarded, leave, told

from . import FIGURES, load
from .lib.files import ready, storing

# What all of it and each command says of itself, with examples.
TOLD = {
    "figures": """\
List and draw the figures, animate a scene, judge the claims, show all of it.

  python -m figures draw fig11
  python -m figures movie quasi2d --periods 4
""",
    "list": """\
List the figures: names and titles; which ones are in the quick set.

  python -m figures list
""",
    "draw": """\
Compute and draw figures; without names: the quick set.

  python -m figures draw fig10 fig11 --out pictures
  python -m figures draw --all --quick            # every figure, on coarse grids
""",
    "movie": """\
Animate a scene: GIF, and MP4 where FFmpeg is there.

  python -m figures movie quasi2d --periods 4
  python -m figures movie my_rods --set plate.amplitude_cm=0.03 --out row.gif
""",
    "claims": """\
Judge what the paper claims: claims.json, claims.md.

  python -m figures claims --quick                # short runs, for a first look
  python -m figures claims
""",
    "paper": """\
Make everything in full: the figures, the movie, the claims, the page.

The same command goes on where it stopped.

  python -m figures paper --estimate              # how long it takes, no more (20 s)
  python -m figures paper
""",
    "prices": """\
Measure all prices anew, on this machine: ten minutes at most.

  python -m figures prices
""",
    "index": """\
Write one page of all that the folder holds: index.html.

  python -m figures index
  python -m figures index --out pictures
""",
    "explore": """\
Open a window of sliders: one impact and the drift.

  python -m figures explore
  python -m figures explore --tilt-deg 40 --friction 0.5 --out setting.png     # no window
""",
    "readme": """\
Write the measured parts of the README from the gallery, in a checkout.

  python -m figures readme
""",
}

PRICES = "prices.txt", "prices.json", "prices.png"
CLAIMS, PAGE = ("claims.json", "claims.md"), "index.html"


def _replacing(path: Path) -> AbstractContextManager[Path]:
    """A file to write beside `path`, which takes its place once it is whole."""
    from md.files import replacing  # late: the list of figures needs no Numba

    path.parent.mkdir(parents=True, exist_ok=True)
    return replacing(path)


def _files(*names: str) -> list[str]:
    """Files of these figures."""
    return [f"{name}.{kind}" for name in names for kind in ("npz", "png", "pdf")]


def _produce(name: str, out: Path, quick: bool) -> tuple[list[Path], str]:
    """Write NAME.npz, NAME.png and NAME.pdf; returns them, and the module's `summary` if any."""
    import matplotlib.pyplot as plt

    from impact._generated import DIGEST

    from .lib.data import keep

    module = load(name)
    data = module.data(quick=quick)
    picture = module.draw(data)
    stamp = {"Title": f"{FIGURES[name].title} (impact {DIGEST})"}
    npz, png, pdf = paths = [out / file for file in _files(name)]
    try:
        with _replacing(npz) as part:
            keep(part, name, quick, data)
        with _replacing(png) as part:
            picture.savefig(part, dpi=200, metadata=stamp)
        with _replacing(pdf) as part:
            picture.savefig(part, dpi=200, metadata=stamp)
    finally:
        plt.close(picture)
    return paths, module.summary(data) if hasattr(module, "summary") else ""


def _draw(arguments: argparse.Namespace) -> int:
    known = ", ".join(FIGURES)
    for name in arguments.names:
        if name not in FIGURES:
            raise CommandError(f"there is no figure {name!r}; known: {known}")
    if arguments.all and arguments.names:
        raise CommandError(f"--all draws every figure and takes no names, got {arguments.names[0]}")
    quick_set = [name for name, entry in FIGURES.items() if entry.quick]
    names = list(FIGURES) if arguments.all else list(dict.fromkeys(arguments.names)) or quick_set

    import matplotlib as mpl
    from tqdm import tqdm

    mpl.use("Agg")
    bar = tqdm(names, desc="drawing", unit="figure", disable=None, leave=False)
    with storing(arguments.out, arguments.store, *_files(*names)) as out:
        for name in bar:
            bar.set_postfix_str(name)
            (npz, png, pdf), summary = _produce(name, out, arguments.quick)
            bar.write(f"{png}  {pdf.name}  {npz.name}")
            if summary:
                bar.write(summary)
    return 0


def _prices(arguments: argparse.Namespace) -> int:
    import matplotlib as mpl
    import matplotlib.pyplot as plt
    import numpy as np
    from tqdm import tqdm

    from .cost import price_page as price_list

    mpl.use("Agg")
    found, names = {}, price_list.known()
    bar = tqdm(names, desc="prices", unit="figure", disable=None, leave=False)
    with storing(arguments.out, arguments.store, *_files(*names), *PRICES) as out:
        for name in bar:
            bar.set_postfix_str(name)
            (npz, png, pdf), _ = _produce(name, out, quick=True)
            bar.write(f"{png}  {pdf.name}  {npz.name}")
            with np.load(npz) as stored:
                found[name] = {key: stored[key] for key in stored if key != "provenance"}
    words, picture = price_list.summary(found), price_list.draw(found)
    plain = json.dumps(price_list.numbers(found), indent=1, ensure_ascii=False, allow_nan=False)
    *texts, png = [out / name for name in PRICES]
    for path, content in zip(texts, (words, plain), strict=True):
        with _replacing(path) as part:
            part.write_text(content + "\n", encoding="utf-8")
    with _replacing(png) as part:
        picture.savefig(part, dpi=200)
    plt.close(picture)
    print(f"{words}\n\n{texts[0]}  {png.name}")
    return 0


def _movie(arguments: argparse.Namespace) -> int:
    import matplotlib as mpl
    from matplotlib.animation import FFMpegWriter

    import md

    from .pages import movie

    mpl.use("Agg")
    out, kinds = arguments.out, ("gif", "mp4") if FFMpegWriter.isAvailable() else ("gif",)
    names = [f"{Path(arguments.scene).stem}.{kind}" for kind in kinds]
    if out.suffix == ".gif":
        names, out = [out.name], out.parent
    elif out.suffix and not out.is_dir():
        raise CommandError(f"out must be a folder or a file that ends in .gif, got {out}")
    try:
        scene = md.load(arguments.scene, arguments.set)
        paths = ready(out, *names)
        film = movie.record(scene, arguments.periods, arguments.frames, progress=True)
    except (TypeError, ValueError, md.RunError) as error:
        raise CommandError(error, 1 if isinstance(error, md.RunError) else 2) from None
    for path in paths:
        with _replacing(path) as part:
            movie.write(film, part, progress=True)
        print(f"{path}  {film.pictures} frames")
    return 0


def _claims(arguments: argparse.Namespace) -> int:
    from .claims import verdicts as claims

    with storing(arguments.out, arguments.store, *CLAIMS) as out:
        report = claims.judge(arguments.quick, progress=True)
    text = json.dumps(claims.plain(report), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    for name, content in zip(CLAIMS, (text, claims.page(report)), strict=True):
        with _replacing(out / name) as part:
            part.write_text(content, encoding="utf-8")
    print(claims.brief(report))
    return 0


def _paper(arguments: argparse.Namespace) -> int:
    from .pages import everything as paper

    made = *_files(*FIGURES), "quasi2d.gif", "quasi2d.mp4", *CLAIMS, PAGE
    with storing(arguments.out, arguments.store, *made) as out:
        print(paper.estimate(out), flush=True)
        names = paper.left(out)
    if arguments.estimate:
        return 0
    where, store = ["--out", str(out)], ["--store", str(arguments.store or out / "rows.db")]
    commands = [["draw", *names, *store]] if names else []
    commands += [["movie", "quasi2d", "--periods", "4"], ["claims", *store], ["index"]]
    codes = (main([*command, *where]) for command in commands)
    return next((code for code in codes if code), 0)


def _index(arguments: argparse.Namespace) -> int:
    out = arguments.out

    from .pages import index

    try:
        files = index.files(out)
    except ValueError as error:
        raise CommandError(error) from None
    ready(out, *files)
    for name, content in files.items():
        with _replacing(out / name) as part:
            part.write_bytes(content)
    print(out / PAGE)
    return 0


def _explore(arguments: argparse.Namespace) -> int:
    given, out = dict(vars(arguments)), arguments.out
    for other in ("command", "run", "out"):
        del given[other]
    if out:
        import matplotlib as mpl

        mpl.use("Agg")
    from .pages import explore
    from .pages.setting import Setting

    try:
        start = Setting(**given)
        if out and out.suffix != ".png":
            raise ValueError(f"out must be a file that ends in .png, got {out}")
        if out:
            ready(out.parent, out.name)
    except ValueError as error:
        raise CommandError(error) from None
    if out:
        with _replacing(out) as part:
            explore.write(start, part)
        print(out)
    elif not explore.run(start):
        raise CommandError("no display to open a window on; --out FILE.png draws it")
    return 0


def _readme(_: argparse.Namespace) -> int:
    from .pages import readme

    TARGET = readme.TARGET
    if not TARGET.is_file():
        raise CommandError(f"it needs a source checkout; {TARGET.parent} has no {TARGET.name}")
    try:
        text = TARGET.read_text(encoding="utf-8")
        new = readme.refreshed(text)
    except (OSError, ValueError) as error:
        raise CommandError(error) from None
    if new != text:
        with _replacing(TARGET) as part:
            part.write_text(new, encoding="utf-8")
    print(f"{TARGET}  {'as it was' if new == text else 'written anew'}")
    return 0


def _list(_: argparse.Namespace) -> int:
    width = max(map(len, FIGURES))
    for name, entry in FIGURES.items():
        print(f"{name:<{width}}  {'quick' if entry.quick else '     '}  {entry.title}")
    return 0


def _parser() -> Parser:
    parser = Parser(prog="python -m figures", description=TOLD["figures"])
    commands = parser.add_subparsers(dest="command", required=True)
    listing = commands.add_parser("list", **told(TOLD["list"]))
    listing.set_defaults(run=_list)
    draw = commands.add_parser("draw", **told(TOLD["draw"]))
    draw.add_argument("names", nargs="*", metavar="NAME", help="figures to draw")
    draw.add_argument("--all", action="store_true", help="every figure")
    draw.add_argument("--quick", action="store_true", help="coarser grids, for a first look")
    draw.set_defaults(run=_draw)
    film = commands.add_parser("movie", **told(TOLD["movie"]))
    film.add_argument("scene", help="TOML file, or the name of an example")
    film.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="change a key"
    )
    film.add_argument("--periods", type=int, default=20, help="of the plate (default 20)")
    film.add_argument("--frames", type=int, default=8, help="a period (default 8)")
    film.add_argument(
        "--out", type=Path, default=Path("out"), help="folder (default: out), or FILE.gif"
    )
    film.set_defaults(run=_movie)
    judging = commands.add_parser("claims", **told(TOLD["claims"]))
    judging.add_argument("--quick", action="store_true", help="short runs, for a first look")
    judging.set_defaults(run=_claims)
    paper = commands.add_parser("paper", **told(TOLD["paper"]))
    paper.add_argument("--estimate", action="store_true", help="say how long it takes, no more")
    paper.set_defaults(run=_paper)
    prices = commands.add_parser("prices", **told(TOLD["prices"]))
    prices.set_defaults(run=_prices)
    index = commands.add_parser("index", **told(TOLD["index"]))
    index.set_defaults(run=_index)
    words = commands.add_parser("readme", **told(TOLD["readme"]))
    words.set_defaults(run=_readme)
    for command in (draw, judging, paper, prices, index):
        command.add_argument("--out", type=Path, default=Path("out"), help="folder (default: out)")
    for command in (draw, judging, paper, prices):
        command.add_argument(
            "--store", type=Path, metavar="FILE", help="of the runs (default: rows.db in --out)"
        )
    window = commands.add_parser(
        "explore",
        **told(TOLD["explore"]),
        argument_default=argparse.SUPPRESS,
    )
    window.add_argument("--tilt-deg", type=float, metavar="PHI", help="0 to 90 (default 30)")
    window.add_argument("--friction", type=float, metavar="MU", help="0 to 1 (default 0.3)")
    window.add_argument("--restitution", type=float, metavar="E", help="0 to 1 (default 0.65)")
    window.add_argument("--ratio", type=float, help="-c_z/c_x before, 0.1 to 10 (default 2)")
    window.add_argument("--length", type=float, help="in diameters, 1 to 20 (default 8)")
    window.add_argument("--shape", help="thin, round (default) or flat")
    window.add_argument("--law", help="newton (default), poisson or stronge")
    window.add_argument("--out", type=Path, default=None, metavar="FILE.png", help="no window")
    window.set_defaults(run=_explore)
    commands.metavar = " | ".join(commands.choices)
    return parser


def main(argv: list[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    arguments = _parser().parse_args(argv)
    return guarded(f"python -m figures {arguments.command}", lambda: arguments.run(arguments))


if __name__ == "__main__":
    leave("python -m figures", main)
