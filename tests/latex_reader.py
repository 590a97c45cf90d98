"""Reader of LaTeX: what the formulas of the report say, as expressions."""

import re

import sympy as sp

FUNCTIONS = {"\\sin": sp.sin, "\\cos": sp.cos, "\\arccos": sp.acos, "\\arctan": sp.atan}
ENDS = {"+", "-", "}", "\\right", "\\,", ","}


class Reader:
    """One formula, read from left to right; `letters` gives symbols by their LaTeX."""

    def __init__(self, tex, letters):
        self.rest = re.findall(r"\\(?:[A-Za-z]+|,)|\d+(?:\.\d+)?|\S", tex)[::-1]
        self.letters = letters

    def take(self, *wanted):
        token = self.rest.pop()
        assert not wanted or token in wanted, token
        return token

    def next(self, *wanted):
        return bool(self.rest) and self.rest[-1] in wanted

    def sum(self):
        total = -self.product() if self.next("-") and self.take() else self.product()
        while self.next("+", "-"):
            total += self.product() if self.take() == "+" else -self.product()
        return total

    def product(self):
        result = self.power()
        while self.rest and self.rest[-1] not in ENDS:
            result *= 1 / self.power() if self.next("/") and self.take() else self.power()
        return result

    def power(self):
        base = self.atom()
        return base ** self.group() if self.next("^") and self.take() else base

    def group(self):
        self.take("{")
        inner = self.sum()
        self.take("}")
        return inner

    def beta(self):
        for part in ("{", "B", "}", "\\left", "("):
            self.take(part)
        first = self.sum()
        self.take(",")
        second = self.sum()
        self.take("\\right"), self.take(")")
        return sp.beta(first, second)

    def integral(self):
        """From the limits to the letter that is integrated over."""
        self.take("\\limits"), self.take("_")
        low = self.group()
        self.take("^")
        high = self.group()
        integrand = self.product()
        self.take("\\,"), self.take("d")
        return sp.Integral(integrand, (self.atom(), low, high))

    def text(self):
        """A group as it is written."""
        found = self.take("{")
        while found.count("{") > found.count("}"):
            found += self.take()
        return found

    def atom(self):
        token = self.take()
        if re.fullmatch(r"[\d.]+", token):
            return sp.Rational(token)
        if token == "\\frac":
            return self.group() / self.group()
        if token == "\\sqrt":
            index = 2
            if self.next("["):
                self.take()
                index = int(self.take())
                self.take("]")
            return sp.root(self.group(), index)
        if token == "\\pi":
            return sp.pi
        if token == "\\left":
            kind = self.take("(", "|")
            inner = self.group() if kind == "|" else self.sum()
            self.take("\\right")
            self.take(")", "|")
            return sp.Abs(inner) if kind == "|" else inner
        if token == "\\operatorname":
            return self.beta()
        if token == "\\int":
            return self.integral()
        if token in FUNCTIONS:
            exponent = self.group() if self.next("^") and self.take() else 1
            return FUNCTIONS[token](self.group()) ** exponent
        named = token in ("\\mathit", "\\dot")
        name = token + (self.text() if named else "")
        if token == "{":  # a letter with a prime
            name += self.take() + self.take("}") + self.take("'")
        return self.letters[name + (self.take() + self.text() if self.next("_") else "")]


def read(tex, letters):
    """The expression that a formula stands for."""
    reader = Reader(tex, letters)
    result = reader.sum()
    assert not reader.rest, reader.rest
    return result
