"""The paper, derived from Newton's laws with SymPy and compared with what is printed.

`derivations.registry` holds every equation as printed and as derived, with a verdict and its proof.
From a shell: `python -m derivations check`, `report`, `generate`.
"""
