"""The paper's claims, judged: what each says, what was measured, within which limits it holds.

Where the verdict on a claim, say S13, is decided
-------------------------------------------------
claims.toml        the claim in words, its numbers and their limits, why these limits, our remark
over_tilt          numbers of a row over its tilt, for any contact law: those of S13 are here
measure_rows       other numbers of one impact and of plane rows
measure_annulus    the same of the annulus, of the experiment's geometry and of its map of drift
evidence           the data of figures and runs that these take
uncertainty        a measured number with its error
judge              grades each number by its limits, and the claim by its grades: the verdict

The numbers of a claim are entries of `over_tilt.NUMBERS`, as "S13.small", or what a function
returns that `uncertainty.measures` registers for it; `judge.measure` finds both.
Pages of the verdicts are made in `figures.pages.gallery`.
"""
