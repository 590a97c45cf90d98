"""The paper's claims, judged: what each says, what was measured, within which limits it holds.

Where the verdict on a claim, say S13, is decided
-------------------------------------------------
claims.toml        the claim in words, its numbers and their limits, why these limits, our remark
over_tilt          numbers of a row over its tilt, for any contact law (S13 is here)
measure_rows       `S13_flights` and the like: numbers of one impact and of plane rows
measure_annulus    the same of the annulus, of the experiment's geometry and of its map of drift
uncertainty        a measured number with its error
judge              grades each number by its limits, and the claim by its grades: the verdict

The function that measures a claim begins with the claim's name; `judge.measures` finds it by that.
Pages of the verdicts are made in `figures.pages.gallery`.
"""
