"""Code generation: text of a function from its proved assignments."""

import textwrap

from .lecture import to_text
from .rewrites import Function


def text(function: Function) -> str:
    """Text of a generated function: its head, docstring, assignments and return."""
    body, counts = function.body
    words = function.words
    history = ", ".join(f"{rule} {operations}" for rule, operations in counts.items())
    doc = textwrap.wrap(to_text(f"{words['detail']} Operations: {history}."), 92)
    outputs = " ".join(str(name) for name in body if name in function.outputs)
    returned = words.get("returned", outputs).split()
    lines = [
        f"def {function.name}({', '.join(map(str, function.arguments))}):",
        f'    """{to_text(words["summary"])}',
        "",
        *(f"    {line}" for line in doc),
        '    """',
    ]
    for name, form in function.lines.items():
        if name not in words.get("unused", "").split():
            lines.append(f"    return {form}" if [name] == returned else f"    {name} = {form}")
    if len(returned) > 1:
        lines.append(f"    return {', '.join(returned)}")
    return "\n".join(lines)
