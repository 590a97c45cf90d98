"""The text of a compiled kernel: what it takes and what it looks at."""

import re
from typing import Any, NamedTuple

import numba

WHOLE = r"^define[^\n]*\n.*?^}"  # a function


def fresh(kernel):
    """A kernel compiled here and now: what comes from the disk cache has no text."""
    return numba.njit(error_model="numpy", _nrt=False)(kernel.py_func)


class Text(NamedTuple):
    """Text of a kernel compiled for some arguments, and that of its own function."""

    arguments: dict[str, Any]
    whole: str
    body: str


def text(kernel, **arguments):
    """The kernel's text for the first arguments of these types, which have their names there."""
    wanted = tuple(map(numba.typeof, arguments.values()))
    [mine] = [s for s in kernel.signatures if s[: len(wanted)] == wanted]
    whole = kernel.inspect_llvm(mine)
    path = [*kernel.py_func.__module__.split("."), kernel.py_func.__name__]
    own = rf"define[^\n]*@_ZN{''.join(f'{len(name)}{name}' for name in path)}"
    [body] = [f for f in re.findall(WHOLE, whole, re.M | re.S) if re.match(own, f)]
    return Text(arguments, whole, body)


def place(arguments, path):
    """Numba's name of a field of a nested tuple, as "effects.0.4" for "effects.alone.gravity"."""
    name, *fields = path.split(".")
    group = arguments[name]
    for field in fields:
        name += f".{group._fields.index(field)}"
        group = getattr(group, field)
    return re.escape(name)


def passed(text, path):
    """Numbers and places that an argument hands over, absent ones left out."""
    head = text.body.split("\n", 1)[0]
    given = re.findall(rf"((?:ptr|double|i\d+)\b[^%]*)%arg\.{place(text.arguments, path)}\b", head)
    assert given
    return [one for one in given if "readnone" not in one]


def assert_absent(there, gone, marks):
    """Effects have no code in a text: nothing reads their arguments, their instructions lack.

    Numba names the kernel's arguments in its text. One that is None remains there as a pointer that
    nothing reads. `marks`: an instruction that only the effect of an argument needs.
    """
    code = "\n".join(line for line in gone.body.splitlines()[1:] if " call " not in line)
    for path, mark in marks.items():
        assert passed(there, path)
        assert not passed(gone, path)
        assert not re.search(rf"%arg\.{place(gone.arguments, path)}\b", code)
        if mark:
            assert re.search(mark, there.whole)
            assert not re.search(mark, gone.whole)
