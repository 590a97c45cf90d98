"""The report's connecting text, from lecture.toml: of each section, references, exercises."""

import tomllib
from importlib import resources
from typing import NamedTuple


class Part(NamedTuple):
    """What stands before the entries of a section: paragraphs, then drawings by their names."""

    text: tuple[str, ...]
    drawings: tuple[str, ...] = ()


_TEXT = resources.files(__package__).joinpath("lecture.toml").read_text(encoding="utf-8")
_FOUND = tomllib.loads(_TEXT)


def _paragraphs(text: str) -> tuple[str, ...]:
    return tuple(" ".join(part.split()) for part in text.split("\n\n"))


PARTS = {
    title: Part(_paragraphs(part["text"]), tuple(part.get("drawings", ())))
    for title, part in _FOUND["parts"].items()
}
REFERENCES = tuple(_FOUND["references"])
QUESTIONS = dict(_FOUND["exercises"])
