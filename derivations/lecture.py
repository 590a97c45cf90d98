"""The report's connecting text: what each section is about, its drawings, and the references.

Formulas stand between dollar signs; (12) becomes a link to that entry.
"""

from typing import NamedTuple


class Part(NamedTuple):
    """What stands before the entries of a section: paragraphs, then drawings by their names."""

    text: tuple[str, ...]
    drawings: tuple[str, ...] = ()


PARTS = {
    "Assumptions": Part(
        (
            "All that follows is computed from nine assumptions. Newton's law moves the centre of "
            "mass and Euler's law turns the body; the body is rigid; the impact is so short that "
            "nothing but the contact force acts while it lasts; friction obeys Coulomb's law; one "
            "number, the restitution, says how the contact ends. The last two assumptions are "
            "about "
            "the time between impacts and enter only in the section on stationary translation.",
            r"Coulomb (1785) measured that dry friction is in proportion to the normal force. A "
            r"contact "
            r"that slips feels $|F_x| = \mu F_z$ against its slip. A contact that sticks may "
            r"feel any "
            r"force inside the friction cone $|F_x| \le \mu F_z$: the force follows from the "
            r"condition "
            "that nothing slips, and friction holds as long as that force lies in the cone.",
            "Newton (1687) let spheres of cork, steel and glass collide and found that they part "
            "with "
            "a fixed fraction of the speed with which they met. For the contact point of a rod "
            "this "
            r"is kinematic restitution, $v_f = -\epsilon v_0$, the paper's choice. Two other "
            "definitions, by Poisson and by Stronge, are compared with it further below.",
        ),
        ("geometry", "cone"),
    ),
    "Newton's laws and the contact point": Part(
        (
            "The plate acts on one point of the rod. Its velocity is that of the centre of mass "
            "plus "
            "what the spin adds (3), and so its acceleration feels the force twice: once through "
            "the "
            "centre, once through the turn of the rod. Gravity and the plate's acceleration stay "
            "finite while the force of a short impact does not, so they drop out (4).",
            "The result, (5) and (6), is all of the dynamics: two linear equations. The term with "
            "$XZ$ couples the two directions. A normal force on a tilted rod makes its contact "
            "point "
            "slip, and a friction force changes its normal velocity.",
        ),
    ),
    "Slide": Part(
        (
            "Time plays no role in an impact that is this short. What counts is the impulse so "
            "far, "
            "and the normal impulse $P_z$ grows all the while, so it serves as the clock. Routh "
            "(1905) drew the impact as a path in the plane of the impulses $(P_x, P_z)$. Both "
            "contact "
            "velocities are linear in the impulses, so $u = 0$, the line of sticking, and $v = "
            "0$, the "
            "line of greatest compression, are straight lines. While the contact slips forward the "
            "path is straight, too: it follows the left edge of the friction cone.",
            "If the contact separates before the path meets the line $u = 0$, the impact is one "
            "continuous slide.",
        ),
        ("path-slide",),
    ),
    "Slip-stick": Part(
        (
            "If the path meets $u = 0$, the slip stops. Sticking needs the force (17); if that "
            "lies in "
            "the friction cone (16), the path goes on along the line $u = 0$ until the contact "
            "separates. Friction no longer has a say in where that is, so that the velocities "
            "after "
            "the impact do not depend on its coefficient.",
        ),
        ("path-slip-stick",),
    ),
    "Slip reversal": Part(
        (
            "If the force (17) lies outside of the cone, friction cannot hold the contact. The "
            "rod's "
            "own inertia pushes the contact point back, it slips towards $-x$, and friction now "
            "points "
            "forward: the path goes on in parallel to the right edge of the cone.",
        ),
        ("path-slip-reversal",),
    ),
    "Bodies": Part(
        (
            "A rod enters only by $X$, $Z$ and $k$. A thin rod, a spherocylinder and a "
            "flat-ended rod "
            "differ in where they touch the plate and in their gyration radius.",
        ),
    ),
    "Regime boundaries and the thin rod": Part(
        (
            "Which regime an impact has depends on (14) and (16) alone. For a thin rod both are "
            "conditions on tilt and friction, with the approach ratio and the restitution as "
            "parameters of the first one.",
        ),
        ("regimes",),
    ),
    "Other laws of restitution, and energy": Part(
        (
            "Newton's law compares velocities. Poisson (1833) divides the impact at the moment of "
            r"greatest compression, $v = 0$, and lets the impulse of restitution be $\epsilon$ "
            r"times "
            "that of compression. Stronge (1990) compares energies: the normal force gives back "
            r"$\epsilon^2$ of the work that compression took. As long as the normal velocity is "
            "linear in the normal impulse, as it is in a slide, the three say the same. They "
            "differ "
            "when the slip stops, since the slope $dv/dP_z$ then changes.",
            "A law that fixes $v_f$ without regard to what friction does can create energy: Kane "
            "and "
            "Levinson (1985) found this for a double pendulum, and Keller (1986) and Stronge "
            "(1990) "
            "explained it. The entries below give the threshold for a rod. In the same way "
            "Poisson's "
            "and Stronge's laws are seen to be safe.",
        ),
    ),
    "Stationary translation": Part(
        (
            "A rod that bounces on a vibrated plate cannot speed up for ever. The paper closes the "
            "problem with three conditions on a mean landing: no spin before it, no change of the "
            "horizontal velocity by it, and a vertical velocity that is turned round. Put into the "
            "impact they leave two linear equations, and their solution is the drift (24), (27).",
        ),
    ),
    "Best tilt, stability, Painleve's paradox": Part(
        (
            "Painlevé (1895) found that a rigid rod that slides with much friction can have no "
            "solution at all: a normal force would accelerate its contact point into the plate, "
            "not "
            "out of it. In the plane of impulses the paradox resolves: with $dv/dP_z < 0$ the "
            "normal "
            "velocity first grows downwards, the slip stops, and only then is the contact pressed "
            "apart. The impulse stays finite even if the contact point hardly moved towards the "
            "plate "
            "before: an impact without collision (Génot and Brogliato 1999).",
        ),
    ),
    "Appendix A: dimensions": Part(
        (
            r"The simulations replace the rigid contact by a soft one. Hertz (1882) solved the "
            r"contact "
            r"of two elastic bodies: the force grows as the overlap to the power $3/2$, since "
            r"the area "
            "of contact grows with it. Each constant of Appendix A must have the dimension that "
            "makes "
            "its term a force.",
        ),
    ),
    "Sentences of the text": Part(
        ("What the text states in words is computed here, where it says a number or a sign.",),
    ),
}

REFERENCES = (
    "C. A. Coulomb, Théorie des machines simples, en ayant égard au frottement de leurs parties "
    "et à "
    "la roideur des cordages, Paris (1785).",
    "F. Génot and B. Brogliato, New results on Painlevé paradoxes, Eur. J. Mech. A/Solids 18, 653 "
    "(1999).",
    "H. Hertz, Über die Berührung fester elastischer Körper, J. reine angew. Math. 92, 156 (1882).",
    "T. R. Kane and D. A. Levinson, Dynamics: Theory and Applications, McGraw-Hill, New York "
    "(1985).",
    "J. B. Keller, Impact with friction, J. Appl. Mech. 53, 1 (1986).",
    "I. Newton, Philosophiae naturalis principia mathematica, Scholium to the laws of motion, "
    "London "
    "(1687).",
    "P. Painlevé, Sur les lois du frottement de glissement, C. R. Acad. Sci. Paris 121, 112 "
    "(1895).",
    "S. D. Poisson, Traité de mécanique, 2nd ed., Bachelier, Paris (1833).",
    "E. J. Routh, Dynamics of a System of Rigid Bodies, elementary part, 7th ed., Macmillan, "
    "London "
    "(1905).",
    "W. J. Stronge, Rigid body collisions with friction, Proc. R. Soc. Lond. A 431, 169 (1990).",
    "D. Volfson, A. Kudrolli and L. S. Tsimring, Anisotropy-driven dynamics in vibrated granular "
    "rods, "
    "Phys. Rev. E 70, 051312 (2004).",
)
