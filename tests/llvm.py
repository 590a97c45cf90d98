"""The text of a compiled kernel: what it takes and what it looks at."""

import re

import numba

WHOLE = r"^define[^\n]*\n.*?^}"  # a function


def fresh(kernel):
    """A kernel compiled here and now: what comes from the disk cache has no text."""
    return numba.njit(error_model="numpy", _nrt=False)(kernel.py_func)


def text(kernel, *arguments):
    """Text of the kernel for the first arguments of these types, and that of its own function."""
    wanted = tuple(map(numba.typeof, arguments))
    [mine] = [s for s in kernel.signatures if s[: len(wanted)] == wanted]
    whole = kernel.inspect_llvm(mine)
    path = [*kernel.py_func.__module__.split("."), kernel.py_func.__name__]
    own = rf"define[^\n]*@_ZN{''.join(f'{len(name)}{name}' for name in path)}"
    [body] = [f for f in re.findall(WHOLE, whole, re.M | re.S) if re.match(own, f)]
    return whole, body


def place(group, path):
    """Numba's name of a field of a nested tuple, as "effects.0.4" for "effects.alone.gravity"."""
    name, *fields = path.split(".")
    for field in fields:
        name += f".{group._fields.index(field)}"
        group = getattr(group, field)
    return name


def looks(body, argument):
    """Instructions of a function that look at an argument, not those that hand it on."""
    code = [line for line in body.splitlines()[1:] if " call " not in line]
    return len(re.findall(rf"%arg\.{re.escape(argument)}\b", "\n".join(code)))


def passed(body, argument):
    """Numbers and places that an argument hands over, absent ones left out."""
    head = body.split("\n", 1)[0]
    given = re.findall(rf"((?:ptr|double|i\d+)\b[^%]*)%arg\.{re.escape(argument)}\b", head)
    assert given
    return [one for one in given if "readnone" not in one]
