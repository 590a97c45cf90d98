"""Command line: list and draw the figures, animate a scene, judge the claims, show all of it.

python -m figures list
python -m figures draw [NAME ...] [--all] [--quick] [--out DIR]
python -m figures movie SCENE [--set KEY=VALUE ...] [--periods N] [--frames F] [--out DIR|FILE.gif]
python -m figures claims [--quick] [--out DIR]
python -m figures paper [--estimate] [--out DIR]
python -m figures prices [--out DIR]
python -m figures index [--out DIR]
python -m figures readme
python -m figures explore [--tilt-deg PHI] [--friction MU] ... [--out FILE.png]
"""

import argparse
import json
import os
import platform
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from impact._command import Parser, guarded, leave

from . import FIGURES, load


@contextmanager
def _replacing(path: Path) -> Iterator[Path]:
    """A file to write beside `path`, which takes its place once it is whole."""
    part = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        yield part
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def _provenance() -> dict[str, str]:
    import matplotlib
    import numpy as np

    from impact._generated import DIGEST

    return {
        "impact": DIGEST,  # of the generated closed forms
        "numpy": np.__version__,
        "matplotlib": matplotlib.__version__,
        "python": platform.python_version(),
    }


def _produce(name: str, out: Path, quick: bool) -> tuple[list[Path], str]:
    """Write NAME.npz, NAME.png and NAME.pdf; returns them, and the module's `summary` if any."""
    import matplotlib.pyplot as plt
    import numpy as np

    module, made = load(name), _provenance()
    data = module.data(quick=quick)
    picture = module.draw(data)
    stamp = {"Title": f"{FIGURES[name].title} (impact {made['impact']})"}
    npz, png, pdf = paths = [out / f"{name}.{kind}" for kind in ("npz", "png", "pdf")]
    try:
        with _replacing(npz) as part:
            np.savez_compressed(part, **data, provenance=json.dumps({**made, "quick": quick}))
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
            print(f"figures: there is no figure {name!r}; known: {known}", file=sys.stderr)
            return 2
    quick_set = [name for name, entry in FIGURES.items() if entry.quick]
    names = list(FIGURES) if arguments.all else list(dict.fromkeys(arguments.names)) or quick_set
    arguments.out.mkdir(parents=True, exist_ok=True)

    import matplotlib as mpl
    from tqdm import tqdm

    mpl.use("Agg")
    bar = tqdm(names, desc="drawing", unit="figure", disable=None, leave=False)
    for name in bar:
        bar.set_postfix_str(name)
        (npz, png, pdf), summary = _produce(name, arguments.out, arguments.quick)
        bar.write(f"{png}  {pdf.name}  {npz.name}")
        if summary:
            bar.write(summary)
    return 0


def _prices(arguments: argparse.Namespace) -> int:
    out = arguments.out
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryFile(dir=out):  # or it could not be written in the end
        pass

    import matplotlib as mpl
    import matplotlib.pyplot as plt
    import numpy as np
    from tqdm import tqdm

    from . import price_list

    mpl.use("Agg")
    found = {}
    bar = tqdm(price_list.known(), desc="prices", unit="figure", disable=None, leave=False)
    for name in bar:
        bar.set_postfix_str(name)
        (npz, png, pdf), _ = _produce(name, out, quick=True)
        bar.write(f"{png}  {pdf.name}  {npz.name}")
        with np.load(npz) as stored:
            found[name] = {key: stored[key] for key in stored if key != "provenance"}
    words, picture = price_list.summary(found), price_list.draw(found)
    plain = json.dumps(price_list.numbers(found), indent=1, ensure_ascii=False, allow_nan=False)
    for name, content in (("prices.txt", words), ("prices.json", plain)):
        with _replacing(out / name) as part:
            part.write_text(content + "\n", encoding="utf-8")
    with _replacing(out / "prices.png") as part:
        picture.savefig(part, dpi=200)
    plt.close(picture)
    print(f"{words}\n\n{out / 'prices.txt'}  prices.png")
    return 0


def _movie(arguments: argparse.Namespace) -> int:
    import matplotlib as mpl
    from matplotlib.animation import FFMpegWriter

    import md

    from . import movie

    mpl.use("Agg")
    out, kinds = arguments.out, ("gif", "mp4") if FFMpegWriter.isAvailable() else ("gif",)
    paths = [out / f"{Path(arguments.scene).stem}.{kind}" for kind in kinds]
    if out.suffix == ".gif":
        paths, out = [out], out.parent
    elif out.suffix and not out.is_dir():
        print(
            f"figures: out must be a folder or a file that ends in .gif, got {out}", file=sys.stderr
        )
        return 2
    try:
        scene = md.load(arguments.scene, arguments.set)
        film = movie.record(scene, arguments.periods, arguments.frames, progress=True)
    except (TypeError, ValueError, md.RunError) as error:
        print(f"figures: {error}", file=sys.stderr)
        return 1 if isinstance(error, md.RunError) else 2
    out.mkdir(parents=True, exist_ok=True)
    for path in paths:
        with _replacing(path) as part:
            movie.write(film, part, progress=True)
        print(f"{path}  {film.pictures} frames")
    return 0


def _no_store() -> bool:
    """Whether the store of rows cannot be used; says why."""
    from md.store import Store, StoreError

    from .rows import store

    try:
        Store(store()).database.close()
    except StoreError as error:
        print(f"figures: {error}", file=sys.stderr)
        return True
    return False


def _claims(arguments: argparse.Namespace) -> int:
    from . import claims

    arguments.out.mkdir(parents=True, exist_ok=True)
    if _no_store():
        return 2
    report = claims.judge(arguments.quick, progress=True)
    text = json.dumps(claims.plain(report), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    for name, content in (("claims.json", text), ("claims.md", claims.page(report))):
        with _replacing(arguments.out / name) as part:
            part.write_text(content, encoding="utf-8")
    print(claims.brief(report))
    return 0


def _paper(arguments: argparse.Namespace) -> int:
    from . import paper

    arguments.out.mkdir(parents=True, exist_ok=True)
    if _no_store():
        return 2
    print(paper.estimate(arguments.out), flush=True)
    if arguments.estimate:
        return 0
    names = paper.left(arguments.out)
    commands = [["draw", *names]] if names else []
    commands += [["movie", "quasi2d", "--periods", "4"], ["claims"], ["index"]]
    codes = (main([*command, "--out", str(arguments.out)]) for command in commands)
    return next((code for code in codes if code), 0)


def _index(arguments: argparse.Namespace) -> int:
    out = arguments.out
    out.mkdir(parents=True, exist_ok=True)

    from . import index

    for name, content in index.files(out).items():
        (out / name).parent.mkdir(exist_ok=True)
        with _replacing(out / name) as part:
            part.write_bytes(content)
    print(out / "index.html")
    return 0


def _explore(arguments: argparse.Namespace) -> int:
    given, out = dict(vars(arguments)), arguments.out
    for other in ("command", "run", "out"):
        del given[other]
    if out:
        import matplotlib as mpl

        mpl.use("Agg")
    from . import explore
    from .setting import Setting

    try:
        start = Setting(**given)
        if out and out.suffix != ".png":
            raise ValueError(f"out must be a file that ends in .png, got {out}")
    except ValueError as error:
        print(f"figures: {error}", file=sys.stderr)
        return 2
    if out:
        out.parent.mkdir(parents=True, exist_ok=True)
        with _replacing(out) as part:
            explore.write(start, part)
        print(out)
    elif not explore.run(start):
        print("figures: no display to open a window on; --out FILE.png draws it", file=sys.stderr)
        return 2
    return 0


def _readme(_: argparse.Namespace) -> int:
    from . import readme

    try:
        text = readme.TARGET.read_text(encoding="utf-8")
        new = readme.refreshed(text)
    except (OSError, ValueError) as error:
        print(f"figures: {error}", file=sys.stderr)
        return 2
    if new != text:
        with _replacing(readme.TARGET) as part:
            part.write_text(new, encoding="utf-8")
    print(f"{readme.TARGET}  {'as it was' if new == text else 'written anew'}")
    return 0


def _list(_: argparse.Namespace) -> int:
    width = max(map(len, FIGURES))
    for name, entry in FIGURES.items():
        print(f"{name:<{width}}  {'quick' if entry.quick else '     '}  {entry.title}")
    return 0


def main(argv: list[str] | None = None) -> int:
    """Run one command; returns the exit code."""
    parser = Parser(prog="python -m figures", description=__doc__.splitlines()[0])
    commands = parser.add_subparsers(
        dest="command",
        required=True,
        metavar="list | draw | movie | claims | prices | paper | index | explore | readme",
    )
    listing = commands.add_parser("list", help="names and titles")
    listing.set_defaults(run=_list)
    draw = commands.add_parser("draw", help="compute and draw; without names: the quick set")
    draw.add_argument("names", nargs="*", metavar="NAME", help="figures to draw")
    draw.add_argument("--all", action="store_true", help="every figure")
    draw.add_argument("--quick", action="store_true", help="coarser grids, for a first look")
    draw.add_argument("--out", type=Path, default=Path("out"), help="folder (default: out)")
    draw.set_defaults(run=_draw)
    film = commands.add_parser("movie", help="animate a scene: GIF, and MP4 where FFmpeg is there")
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
    judging = commands.add_parser("claims", help="judge what the paper claims: claims.json, .md")
    judging.add_argument("--quick", action="store_true", help="short runs, for a first look")
    judging.set_defaults(run=_claims)
    paper = commands.add_parser("paper", help="every figure in full, the movie and the claims")
    paper.add_argument("--estimate", action="store_true", help="say how long it takes, no more")
    paper.set_defaults(run=_paper)
    prices = commands.add_parser("prices", help="measure all prices anew: ten minutes at most")
    prices.set_defaults(run=_prices)
    index = commands.add_parser("index", help="one page of all that the folder holds: index.html")
    index.set_defaults(run=_index)
    words = commands.add_parser("readme", help="measured parts of the README, from the gallery")
    words.set_defaults(run=_readme)
    for command in (judging, paper, prices, index):
        command.add_argument("--out", type=Path, default=Path("out"), help="folder (default: out)")
    window = commands.add_parser(
        "explore",
        help="a window of sliders: one impact and the drift",
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
    arguments = parser.parse_args(argv)
    return guarded("figures", lambda: arguments.run(arguments))


if __name__ == "__main__":
    leave(main())
