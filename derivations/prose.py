"""Small formulas outside the derivation: left-hand sides (LaTeX) and names within sentences.

`left_hand_side` turns the little LaTeX of `Equation.symbol` into MathML. `to_html` and `to_latex`
set sentences that were written for a terminal: c_x' and mu become letters with indices, k^2 gets
an exponent, (12) becomes a link, and quotes, minus signs and arrows their proper characters.
"""

import html
import re
from collections.abc import Callable

from sympy.printing.pretty.pretty_symbology import greek_unicode

_NAMES = "alpha gamma delta epsilon eta theta kappa mu pi phi omega Gamma Delta"
_GREEK = {name: greek_unicode[name] for name in _NAMES.split(" ")}
_THIN = '<mspace width="0.17em"/>'
_FUNCTIONS = {f"\\{name}": f"<mi>{name}</mi>" for name in ("sin", "cos", "tan", "max")}
_BOLD = '<mi mathvariant="normal" style="font-weight:bold">'
_COMMANDS = {
    **{f"\\{name}": f"<mi>{letter}</mi>" for name, letter in _GREEK.items()},
    **_FUNCTIONS,
    "\\partial": "<mi>∂</mi>",
    "\\int": "<mo>∫</mo>",
    "\\,": _THIN,
}
_SIGNS = {
    **{bracket: f'<mo stretchy="false">{bracket}</mo>' for bracket in "()[]"},
    "/": '<mo lspace="0" rspace="0">/</mo>',
    "-": "<mo>−</mo>",
    ">": "<mo>&gt;</mo>",
    "*": "<mo>∗</mo>",
}


def _scripts(base: str, below: str, above: str) -> str:
    if below and above:
        return f"<msubsup>{base}{below}{above}</msubsup>"
    if below:
        return f"<msub>{base}{below}</msub>"
    return f"<msup>{base}{above}</msup>" if above else base


def _atom(rest: list[str]) -> str:
    """The next letter, number, sign, command or group; `rest` is reversed."""
    token = rest.pop()
    if token == "{":
        inner = _row(rest, "}")
        rest.pop()
        return inner
    if token == "\\mathbf":
        return _atom(rest).replace("<mi>", _BOLD)
    if token == "\\dot":
        return f'<mover accent="true">{_atom(rest)}<mo>˙</mo></mover>'
    if token.startswith("\\"):
        return _COMMANDS[token]
    if token.isdigit():
        return f"<mn>{token}</mn>"
    word = token.strip("{}")
    return f"<mi>{word}</mi>" if word.isalpha() else _SIGNS.get(token, f"<mo>{token}</mo>")


def _row(rest: list[str], end: str = "") -> str:
    """Everything up to `end`, each with its indices, powers and primes."""
    text = ""
    while rest and rest[-1] != end:
        base, below, above = _atom(rest), "", ""
        while rest and rest[-1] in "_^'":
            mark = rest.pop()
            if mark == "_":
                below = _atom(rest)
            else:
                above += "<mo>′</mo>" if mark == "'" else _atom(rest)
        text += _scripts(base, below, above) + _THIN * (base in _FUNCTIONS.values())
    return f"<mrow>{text}</mrow>"


def left_hand_side(tex: str) -> str:
    r"""MathML of a left-hand side such as c_x' or \dot v_z; KeyError for an unknown command."""
    return _row(re.findall(r"\\[A-Za-z]+|\\.|\d+|\{[A-Za-z]+\}|\S", tex)[::-1])


# ---- sentences --------------------------------------------------------------------------------

_LETTER = (
    r"(?:XZ|(?<!Section\ )[B-HJ-Zb-z](?!\.\w|:)|A(?=[,)]|\ [C−])|I(?=\)|\ of\b)|a(?=/|\ [−+=]))"
    r"(?![A-Za-z0-9_’])"
)
_TOKEN = re.compile(
    rf"""
    (?P<code>`[^`]+`)
    | (?P<plain>\d?\([a-f](?:,\ ?[a-f])*\)         # panels
        | (?<=\bin\ )(?:m\^2|m/s|1/s|m)(?=[,.;]) | \bcm/s\b   # units
        | Appendix\ A | Sections\ \w+\ and\ \w+)
    | (?P<ref>\(B?\d+\))
    | (?P<power>\^(?:\([^()]*\)|\d+))
    | (?<![A-Za-z0-9_’])(?P<d>d(?=(?:mu|u|v|c|P)\b|P_))?
      (?P<name>(?:{"|".join(sorted([*_GREEK, "eps"], key=len, reverse=True))})(?![A-Za-z])
        | root(?=_) | [A-Za-z](?=_) | (?<=d)[uvcP](?![A-Za-z]) | {_LETTER})
      (?:_(?P<sub>\*|[A-Za-z0-9]+))?(?P<prime>′)?
    """,
    re.VERBOSE,
)
_CLEANED = (
    (r"(_\w+)'", r"\1′"),
    (r"'", "’"),
    (r'(^|[\s(\[])"', r"\1“"),
    (r'"', "”"),
    (r"->", "→"),
    (r"(?<![\w)\]’])-(?=[\w(])|(?<= )-(?= )", "−"),
    (r"sqrt\(", "√("),
    (r"(?<=\d)-(?=eps|\s)", "−"),
    (r"(?<=\))-(?=\()", "–"),
    (r"(?<=\w) \. (?=\w)", " · "),
    (r">=", "≥"),
    (r"<=", "≤"),
)
_TEX = {"“": "``", "”": "''", "’": "'", "→": r"$\to$", "−": "$-$", "√": r"$\surd$", "·": r"$\cdot$"}
_TEX |= {sign: f"${sign}$" for sign in "<>|"} | {"–": "--"}
_TEX |= {"≥": r"$\ge$", "≤": r"$\le$", "′": "$'$", "\\": r"\textbackslash{}"}
_TEX |= {sign: f"\\{sign}" for sign in "&%#_{}$"} | {"^": r"\^{}", "~": r"\~{}"}


def _set(text: str, plain: Callable[[str], str], token: Callable[[re.Match], str]) -> str:
    """`text`, cleaned, its formulas set by `token` and the rest by `plain`."""
    for pattern, replacement in _CLEANED:
        text = re.sub(pattern, replacement, text)
    result, end = "", 0
    for match in _TOKEN.finditer(text):
        result += plain(text[end : match.start()]) + token(match)
        end = match.end()
    return result + plain(text[end:])


def to_html(text: str, link: Callable[[str], str] = "".format) -> str:
    """A sentence as HTML; `link` gives the address of an equation's number, or nothing."""

    def plain(part: str) -> str:
        return html.escape(part, quote=False)

    def token(match: re.Match) -> str:
        kind, whole = match.lastgroup, plain(match[0])
        if match["code"]:
            return f"<code>{whole[1:-1]}</code>"
        if match["power"]:
            return f"<sup>{whole[1:].strip('()')}</sup>"
        if match["ref"]:
            address = link(match[0][1:-1])
            return f'<a href="{address}">{whole}</a>' if address else whole
        if kind == "plain":
            return whole.replace("^2", "<sup>2</sup>")
        name = "ε" if match["name"] == "eps" else _GREEK.get(match["name"], match["name"])
        sub = (match["sub"] or "").replace("*", "∗")
        sub = f"<var>{sub}</var>" if len(sub) == 1 and sub.isalpha() else sub
        return (
            f"{'<var>d</var>' if match['d'] else ''}<var>{name}</var>"
            + (f"<sub>{sub}</sub>" if sub else "")
            + (match["prime"] or "")
        )

    return _set(text, plain, token)


def tex_escape(text: str) -> str:
    """Plain text, character by character, as LaTeX."""
    return "".join(_TEX.get(letter, letter) for letter in text)


def to_latex(text: str) -> str:
    """A sentence as LaTeX."""

    def token(match: re.Match) -> str:
        if match["code"]:
            return rf"\texttt{{{tex_escape(match[0][1:-1])}}}"
        if match["power"]:
            return f"$^{{{match[0][1:].strip('()')}}}$"
        if match["ref"] or match.lastgroup == "plain":
            return tex_escape(match[0])
        name = "epsilon" if match["name"] == "eps" else match["name"]
        name = f"\\{name}" if name in _GREEK else name
        sub = match["sub"] or ""
        sub = rf"\mathrm{{{sub}}}" if len(sub) > 1 and sub.isalpha() else sub
        return (
            f"${'d' if match['d'] else ''}{name}"
            + (f"_{{{sub}}}" if sub else "")
            + ("'$" if match["prime"] else "$")
        )

    return _set(text, tex_escape, token).replace("$$", "")
