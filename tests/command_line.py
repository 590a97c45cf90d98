"""What the tests of several command lines share."""

from collections.abc import Callable


def refused(call: Callable[[], int], word: str, capsys) -> str:
    """Check one line on stderr, with the word in it, nothing on stdout, exit code 2; the line."""
    assert call() == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    assert word in printed.err
    return printed.err
