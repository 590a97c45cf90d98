"""A page as the tests read it."""

import re
from html import unescape
from html.parser import HTMLParser
from itertools import pairwise

from derivations.lecture import to_html

VOID = {"meta", "wbr", "br", "img", "input"}


class Page(HTMLParser):
    """Ids, addresses, headings, images and the text below each id; fails on wrong nesting."""

    def __init__(self, source):
        super().__init__()
        self.open, self.text = [], {}
        self.ids, self.links, self.headings, self.images, self.tags = [], [], [], [], set()
        self.feed(source)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        assert len(attributes) == len(attrs)
        self.tags.add(tag)
        name = attributes.get("id", "")
        if tag not in VOID:
            self.open.append((tag, name))
        if name:
            self.ids.append(name)
            self.text[name] = ""
        self.links += [attributes[key] for key in ("href", "src") if key in attributes]
        if tag == "img":
            self.images.append(attributes)
        if re.fullmatch("h[1-6]", tag):
            self.headings.append(int(tag[1]))

    def handle_startendtag(self, tag, attrs):
        pass  # MathML's empty elements

    def handle_endtag(self, tag):
        assert self.open.pop()[0] == tag

    def handle_data(self, data):
        for _, name in self.open:
            if name:
                self.text[name] += data


def as_read(source):
    """HTML without its marks."""
    return unescape(re.sub(r"<[^>]+>", "", source))


def plain(sentence):
    """A sentence as it can be read on the page."""
    return as_read(to_html(sentence))


def stands_alone(source, page, *, scripts=False):
    """Fail unless a page needs nothing from outside, and its ids and headings are in order."""
    assert source.startswith('<!DOCTYPE html>\n<html lang="en">')
    assert '<meta name="viewport"' in source
    assert scripts or "script" not in page.tags
    assert not page.tags & {"link", "iframe", "object", "base"}
    assert not re.search(r"https?:|url\((?!#)|@import|<[^>]*\son\w+=", source)
    assert len(page.ids) == len(set(page.ids))
    assert page.headings[0] == page.headings.count(1) == 1
    assert all(after <= before + 1 for before, after in pairwise(page.headings))
