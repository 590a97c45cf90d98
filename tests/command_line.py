"""What the tests of several command lines share."""

from collections.abc import Callable


def refused(call: Callable[[], int], word: str, capsys) -> None:
    """One line on stderr, which holds the word, nothing on stdout, exit code 2."""
    assert call() == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    assert word in printed.err
