"""Independent multiple-precision reference for the planar frictional impact on a plate.

The impulse equations are integrated phase by phase over the normal impulse ``p``.  Every slope
comes from applying an impulse to the body at rest through Newton's and Euler's laws
(`apply_impulse`), so nothing here shares an algebraically reduced coefficient with the closed
forms under test.  Impulses and energies are per unit mass; the contact point is the origin, the
centre of mass lies at ``(X, Z)``, and positive ``omega`` turns +z towards +x.
"""

from collections import namedtuple
from functools import partial

from mpmath import frexp, inf, isinf, isnan, ldexp, mpf, mpmathify, sign, sqrt, workdps

NO_IMPACT, SLIDE, SLIP_STICK, SLIP_REVERSAL = range(4)

# Stand-in for infinite friction.  Float inputs can produce ratios as extreme as 10**-1900, so
# 10**400 could be too small; mpmath exponents are unbounded.  No extra digits are needed: what
# is absorbed next to a term in this number would vanish in the limit anyway.
_HUGE_FRICTION_EXPONENT = 4000


def _finite(mu):
    """Return the friction as a number, huge if it is infinite."""
    return mpf(10) ** _HUGE_FRICTION_EXPONENT if isinf(mu) else mu


# Velocity of a body in the frame of the plate, with the geometry needed to change it.
State = namedtuple("State", "c_x c_z omega X Z k")
# Stretch begin <= p <= end of constant ratio dP_x/dp and slope dv/dp; v is taken at its begin.
Phase = namedtuple("Phase", "ratio begin end v slope")
# Relative distances to the regime boundaries, inf where there is no such boundary.
Margins = namedtuple("Margins", "slide stick")
# Outcome of an impact, with guard digits; energy_change is taken in the frame of the plate.
Reference = namedtuple(
    "Reference", "c_x c_z omega regime P_x P_z slip_velocity normal_velocity energy_change margins"
)


def apply_impulse(state, P_x, P_z):
    """Return `state` after an impulse per unit mass at the contact point."""
    r_x, r_z = -state.X, -state.Z  # lever arm, centre of mass to contact
    torque = r_z * P_x - r_x * P_z
    return state._replace(
        c_x=state.c_x + P_x, c_z=state.c_z + P_z, omega=state.omega + torque / (state.k * state.k)
    )


def contact_velocity(state):
    """Return the tangential and normal velocity of the contact point relative to the plate."""
    return state.c_x - state.omega * state.Z, state.c_z + state.omega * state.X


def kinetic_energy(state):
    """Return the kinetic energy per unit mass in the frame of the plate."""
    return (state.c_x**2 + state.c_z**2 + (state.k * state.omega) ** 2) / 2


def response(state, P_x, P_z):
    """Return the contact velocity that an impulse gives to a body at rest."""
    rest = state._replace(c_x=mpf(0), c_z=mpf(0), omega=mpf(0))
    return contact_velocity(apply_impulse(rest, P_x, P_z))


def _friction_phases(u, v, respond, mu):
    """Return the phases, whether sticking is possible, and the stick ratio.

    `respond` gives the change of the contact velocity under an impulse.
    """
    # The ratio at which a tangential impulse cancels the slip caused by a unit normal impulse.
    stick_ratio = -respond(0, 1)[0] / respond(1, 0)[0]

    phases, p_stop = [], mpf(0)
    if u != 0:
        ratio = -sign(u) * mu
        du, dv = respond(ratio, 1)
        p_stop = -u / du if u * du < 0 else inf
        phases.append(Phase(ratio, mpf(0), p_stop, v, dv))
    sticks = abs(stick_ratio) <= mu
    if not isinf(p_stop):
        if phases:
            v += phases[0].slope * p_stop
        # Slip resumes in the direction that friction is too weak to prevent.  The fallback is
        # for |stick_ratio| = mu within rounding, where sticking and slipping coincide.
        slipping = (-s * mu for s in (1, -1) if s * respond(-s * mu, 1)[0] > 0)
        ratio = stick_ratio if sticks else next(slipping, stick_ratio)
        phases.append(Phase(ratio, p_stop, inf, v, respond(ratio, 1)[1]))
    return phases, sticks, stick_ratio


def _rise_to(phases, target):
    """Return the first ``p`` at which the normal velocity rises to `target`, or inf."""
    for phase in phases:
        if phase.slope > 0:
            p = phase.begin + (target - phase.v) / phase.slope
            if p <= phase.end:
                return p
    return inf


def _work(phases, begin, end):
    """Return the integral of the normal velocity from `begin` to `end`."""
    total = mpf(0)
    for phase in phases:
        a, b = max(begin, phase.begin), min(end, phase.end)
        if a < b:
            total += (b - a) * (phase.v + phase.slope * ((a - phase.begin) + (b - a) / 2))
    return total


def _end_of_impact(phases, v, e, law):
    """Return the total normal impulse."""
    if law == "newton":
        return _rise_to(phases, -e * v)
    p_c = _rise_to(phases, mpf(0))
    if law == "poisson" or e == 0:
        return (1 + e) * p_c
    wanted, begin = -e * e * _work(phases, mpf(0), p_c), p_c
    for phase in phases:
        gain = _work(phases, begin, phase.end)  # 0 if the phase lies in the compression
        if gain >= wanted:  # in the last phase, which has no end, at the latest
            break
        wanted, begin = wanted - gain, max(begin, phase.end)
    v = phase.v + phase.slope * (begin - phase.begin)
    # Root of v d + slope d^2 / 2 = wanted in the form free of cancellation.
    return begin + 2 * wanted / (v + sqrt(v * v + 2 * phase.slope * wanted))


def _walk(u, v, respond, mu, e, law):
    """Return regime, impulse, margins and phases of an impact; without approach there is none."""
    if v >= 0:
        return NO_IMPACT, mpf(0), mpf(0), Margins(inf, inf), []
    phases, sticks, stick_ratio = _friction_phases(u, v, respond, mu)
    P_z = _end_of_impact(phases, v, e, law)
    P_x = sum((q.ratio * (min(q.end, P_z) - q.begin) for q in phases if q.begin < P_z), mpf(0))

    margin = inf
    regime = SLIP_STICK if sticks else SLIP_REVERSAL
    if u != 0:
        perpetual_slip = phases[0]._replace(end=inf)
        margin = _relative_distance(phases[0].end, _rise_to([perpetual_slip], -e * v))
        if phases[0].end >= P_z:
            regime = SLIDE
    return regime, P_x, P_z, Margins(margin, _relative_distance(mu, abs(stick_ratio))), phases


def _spread(numbers):
    """Return the range of the binary exponents of the non-zero finite `numbers`."""
    exponents = [frexp(x)[1] for x in numbers if x != 0 and not isinf(x)] or [0]
    return max(exponents) - min(exponents)


def _relative_distance(a, b):
    """Return |a - b| / max(a, b) for non-negative numbers; inf if either is infinite."""
    if isinf(a) or isinf(b):
        return inf
    return abs(a - b) / max(a, b) if a != b else mpf(0)


def reference_collide(
    c_x, c_z, omega, *, X, Z, k, friction, restitution, plate_velocity=0, law="newton", dps=60
):
    """Return the outcome of an impact.

    Parameters
    ----------
    c_x, c_z, omega : float or mpf
        Velocities before the impact; like all numbers here, taken exactly.
    X, Z, k : float or mpf
        Position of the centre of mass relative to the contact point and gyration radius.
    friction, restitution : float or mpf
        Coulomb's coefficient (may be infinite) and the restitution coefficient in [0, 1].
    plate_velocity : float or mpf
        Velocity of the infinitely heavy plate along its normal.
    law : {"newton", "poisson", "stronge"}
        Meaning of the restitution coefficient.
    dps : int
        Decimal digits to which the result holds.

    Returns
    -------
    Reference
        `margins.slide` compares the normal impulses at which slip stops and at which the impact
        would end under perpetual slip (where the laws agree), `margins.stick` the friction with
        that needed to stick.  The label may also flip where the initial slip changes sign.
    """
    c_x, c_z, omega, V_z, e = map(mpmathify, (c_x, c_z, omega, plate_velocity, restitution))
    X, Z, k, mu = map(mpmathify, (X, Z, k, friction))
    # Twice the digits make products of inputs, hence an initial slip of exactly zero, exact.  The
    # spread covers what cancels when lengths, velocities or friction are of disparate magnitude.
    spread = 2 * _spread((c_x, c_z, V_z, omega * X, omega * Z, omega * k))
    spread += 4 * _spread((X, Z, k)) + 2 * _spread((1, mu))
    with workdps(2 * dps + 20 + spread // 3):
        mu = _finite(mu)
        before = State(c_x, c_z - V_z, omega, X, Z, k)
        respond = partial(response, before)
        regime, P_x, P_z, margins, _ = _walk(*contact_velocity(before), respond, mu, e, law)
        after = apply_impulse(before, P_x, P_z)
        slip, normal = contact_velocity(after)

        if regime == SLIP_STICK:
            slip = mpf(0)  # by definition of the phase; the sum leaves rounding
        energy_change = kinetic_energy(after) - kinetic_energy(before)
        velocities = after.c_x, after.c_z + V_z, after.omega
        return Reference(*velocities, regime, P_x, P_z, slip, normal, energy_change, margins)


def _ulp_error(got, ref, scale, digits):
    """Return |got - ref| in units in the last place of `scale`."""
    error = abs(mpmathify(got) - ref)
    if isnan(error):
        return inf  # a NaN would slip through max() and <=
    if scale == 0:
        return error if error == 0 else inf
    return error / max(ldexp(1, frexp(scale)[1] - digits), ldexp(1, -1074))


def error_in_ulp(got, ref, c_x, c_z, omega, *, X, Z, k, plate_velocity=0, digits=53, **_):
    """Return the largest error of `got` in units in the last place of what cancels in each field.

    Parameters
    ----------
    got : object
        Numbers named like the fields of `Reference`; its energy change is not judged.
    ref : Reference
        The outcome to compare with.
    c_x, c_z, omega, X, Z, k, plate_velocity : float or mpf
        The inputs of the impact, which set the scales together with the impulses of `ref`.
    digits : int
        Bits of the significand: 53 for float64, 24 for float32.
    """
    with workdps(80):
        c_x, c_z, omega, X, Z, k, V_z = map(mpmathify, (c_x, c_z, omega, X, Z, k, plate_velocity))
        scale = max(map(abs, (c_x, c_z - V_z, omega * X, omega * Z, ref.P_x, ref.P_z)))
        turning = max(abs(omega), (abs(X * ref.P_z) + abs(Z * ref.P_x)) / (k * k))
        errors = [_ulp_error(got.omega, ref.omega, turning, digits)]
        for field in ("c_x", "c_z", "P_x", "P_z", "slip_velocity", "normal_velocity"):
            want = getattr(ref, field)
            # A result is never better than its own rounding; c_z is in the frame of the laboratory.
            errors.append(_ulp_error(getattr(got, field), want, max(scale, abs(want)), digits))
        return max(errors)


# Outcome (P_x, P_z, energy change, six velocities) of two bodies, and the size of what is summed.
PairReference = namedtuple("PairReference", "outcome regime margins scales")


def reference_pair(first, second, *, friction, restitution, law="newton", dps=60):
    """Return the outcome of an impact of two bodies, each (mass, k, X, Z, c_x, c_z, omega).

    The scale of an impulse is the size of what is summed to it: the impulse of the first phase,
    and that of the second if its terms, the changes of v in all and in the first phase, add up.
    """
    with workdps(3 * dps + 20):
        light, states = [], []  # what an impulse gives to the body: its sign over the mass
        for sign, body in ((1, first), (-1, second)):
            mass, k, X, Z, c_x, c_z, omega = map(mpmathify, body)
            light.append(sign / mass)
            states.append(State(c_x, c_z, omega, X, Z, k))
        e, mu = mpmathify(restitution), _finite(mpmathify(friction))

        def struck(strike, P_x, P_z):
            return [strike(s, a * P_x, a * P_z) for s, a in zip(states, light, strict=True)]

        def respond(P_x, P_z):
            (u_1, v_1), (u_2, v_2) = struck(response, P_x, P_z)
            return u_1 - u_2, v_1 - v_2

        (u_1, v_1), (u_2, v_2) = map(contact_velocity, states)
        u, v = u_1 - u_2, v_1 - v_2
        regime, P_x, P_z, margins, phases = _walk(u, v, respond, mu, e, law)
        scale_z, scale_x = P_z, abs(P_x)
        if regime > SLIDE:
            last = phases[-1]
            rise = last.v - v
            terms = (abs(rise) + abs(v) + abs(v + respond(P_x, P_z)[1])) / last.slope
            scale_z = last.begin + terms
            scale_x = mu * last.begin + abs(last.ratio) * terms
        scale_z += scale_x / 10**100  # infinite friction is a huge one, for P_z of a slide
        energy, velocities, moved = mpf(0), [], []
        after = struck(apply_impulse, P_x, P_z)
        for sign, a, old, new in zip((1, -1), light, states, after, strict=True):
            velocities += new[:3]
            turned = (abs(old.X) * scale_z + abs(old.Z) * scale_x) / old.k**2
            moved += [
                abs(old.c_x) + scale_x * abs(a),
                abs(old.c_z) + scale_z * abs(a),
                abs(old.omega) + turned * abs(a),
            ]
            if a:
                energy += (kinetic_energy(new) - kinetic_energy(old)) / abs(a)
            else:  # the work of the impulse on what keeps its velocity
                along, across = contact_velocity(old)
                energy += sign * (P_x * along + P_z * across)
        u_f, v_f = (a + b for a, b in zip((u, v), respond(P_x, P_z), strict=True))
        size = scale_x * (abs(u) + abs(u_f)) + scale_z * (abs(v) + abs(v_f))
        outcome = P_x, P_z, energy, *velocities
        return PairReference(outcome, regime, margins, (scale_x, scale_z, size, *moved))
