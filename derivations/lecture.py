"""The report's words, from lecture.toml: connecting text, letters, drawings, exercises."""

import tomllib
from importlib import resources
from typing import NamedTuple


class Part(NamedTuple):
    """What stands before the entries of a section: paragraphs, then drawings by their names."""

    text: tuple[str, ...]
    drawings: tuple[str, ...] = ()


TEXTS = tomllib.loads(resources.files(__package__).joinpath("lecture.toml").read_text("utf-8"))


def _paragraphs(text: str) -> tuple[str, ...]:
    return tuple(" ".join(part.split()) for part in text.split("\n\n"))


PARTS = {
    title: Part(_paragraphs(part["text"]), tuple(part.get("drawings", ())))
    for title, part in TEXTS["parts"].items()
}
REFERENCES = tuple(TEXTS["references"])
