"""Settings of the site: `make docs` builds it of the pages in this folder and of docstrings."""

import re
from importlib import metadata
from pathlib import Path

import nbformat
from docutils.nodes import SkipNode
from myst_nb.core.read import read_myst_markdown_notebook

from derivations.typeset import mathml

project, release = "Rods on a vibrated plate", metadata.version("rod-impact")
extensions = ["myst_nb", "sphinx.ext.autodoc"]
html_theme, html_title = "furo", project
html_copy_source = html_show_copyright = False
html_math_renderer = "mathml"  # needs no script, and no network
default_role = "py:obj"
myst_enable_extensions, myst_heading_anchors = ["dollarmath"], 3
nb_execution_mode, nb_execution_in_temp, nb_execution_raise_on_error = "force", True, True
nb_execution_timeout, nb_output_stderr = 300, "remove"
autodoc_typehints, autodoc_member_order, autodoc_preserve_defaults = "none", "bysource", True


def _formula(display):
    def visit(page, node):
        page.body.append(mathml(node.astext(), display))
        raise SkipNode

    return visit, None


def _sections(app, what, name, thing, options, lines):
    """Docstrings as the site's markup: headings, and lists of `name : what it is`."""
    text = "\n".join(lines).replace("|", r"\|")
    files = r"(Files, as one reads them\n-+\n)((?:.+\n)+)"
    text = re.sub(files, lambda m: f"{m[1]}::\n\n" + re.sub("^", "    ", m[2], flags=re.M), text)
    text = re.sub(r"^(\w.*)\n---+\n", r".. rubric:: \1\n\n", text, flags=re.M)
    item = re.compile(r"^((?:\w+, )*\w+) : (.+(?:\n +.+)*)", re.M)
    text = item.sub(lambda m: re.sub(r"\n +", "\n  ", f"- **{m[1]}**: {m[2]}"), text)
    lines[:] = text.split("\n")


def _write_notebooks(app):
    """Each notebook as a file to download, beside its page."""
    folder = Path(app.outdir, "notebooks")
    folder.mkdir(parents=True, exist_ok=True)
    for page in Path(app.srcdir, "notebooks").glob("*.md"):
        notebook = read_myst_markdown_notebook(page.read_text(encoding="utf-8"))
        nbformat.write(notebook, folder / f"{page.stem}.ipynb")


def _link_notebook(app, name, source):
    folder, _, stem = name.rpartition("/")
    if folder == "notebooks":
        link = f'<a href="{stem}.ipynb" download>Download this page as a Jupyter notebook</a>'
        source[0] = re.sub("^# .+\n", rf"\g<0>\n{link}\n", source[0], count=1, flags=re.M)


def setup(app):
    """Register the formulas and the docstrings' layout; fields stand in the docstrings."""
    app.connect("builder-inited", _write_notebooks)
    app.connect("source-read", _link_notebook)
    app.add_html_math_renderer("mathml", _formula(False), _formula(True))
    app.connect("autodoc-process-docstring", _sections)
    app.connect("autodoc-skip-member", lambda *of: type(of[3]).__name__ == "_tuplegetter" or None)
