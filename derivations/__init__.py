"""The paper, derived from Newton's laws with SymPy and compared with what is printed."""
