"""Known wrong answers of notebook 2.6, with the diagnosis that a student reads. Each is compared with every
component for itself, so one mistake of all components also explains one of them alone.
"""

from itertools import permutations

import numpy as np

from exercises.rigid_body.shown import BODY, BOX, SYMMETRIC

M, A, B, C = BOX
BOOK = tuple((M / 12 * np.array([B**2 + C**2, A**2 + C**2, A**2 + B**2])).tolist())
BODIES = {"exercises 2 and 3": BODY, "exercises 4 and 6": SYMMETRIC, "the book": BOOK}
MOMENT, SPIN, RATE = ("I₁", "I₂", "I₃"), ("ω₁", "ω₂", "ω₃"), ("ω̇₁", "ω̇₂", "ω̇₃")
ORDERS = [order for order in permutations(range(3)) if order != (0, 1, 2)]
# Iᵢ is the component's own moment, Iⱼ and Iₖ are the next two in cyclic order
OWN, NEXT, LAST = "ᵢ", "ⱼ", "ₖ"
PLACES = (OWN, NEXT, LAST)


def named(symbols, order):
    """Return symbols in an order as text: "I₂, I₁, I₃"."""
    return ", ".join(symbols[k] for k in order)


def of_box_moments(box_moments):
    """Declare wrong moments of a box."""

    @box_moments.mistake(
        "moment-order",
        lambda order: (
            f"the right moments in the wrong order: {named(MOMENT, order)}; the first is of the edge a"
        ),
        order=ORDERS,
    )
    def in_another_order(m, a, b, c, order):
        return np.asarray(box_moments(m, a, b, c))[list(order)]

    @box_moments.mistake(
        "moment-order", "the moments are sorted: the first belongs to the edge a, whatever its size"
    )
    def sorted_by_size(m, a, b, c):
        return np.sort(box_moments(m, a, b, c))

    @box_moments.mistake("swapped-arguments", "the arguments are taken as (a, b, c, m): m comes first")
    def mass_last(m, a, b, c):
        return box_moments(c, m, a, b)

    @box_moments.mistake("missing-term", "the moments lack the mass m")
    def without_mass(m, a, b, c):
        return box_moments(1.0, a, b, c)

    @box_moments.mistake("wrong-power", "the edges are not squared: I₁ has b + c instead of b² + c²")
    def edges_not_squared(m, a, b, c):
        return m / 12 * np.array([b + c, a + c, a + b])

    @box_moments.mistake(
        "missing-brackets", "m/12 multiplies only the first square: (b² + c²) needs brackets"
    )
    def without_brackets(m, a, b, c):
        return np.array([m / 12 * b**2 + c**2, m / 12 * a**2 + c**2, m / 12 * a**2 + b**2])

    @box_moments.mistake("wrong-quantity", "the inverse moments instead of the moments")
    def inverse(m, a, b, c):
        return 1 / np.asarray(box_moments(m, a, b, c))

    @box_moments.mistake("sign-flipped", "the difference of the squares instead of their sum")
    def difference(m, a, b, c):
        return m / 12 * np.array([b**2 - c**2, a**2 - c**2, a**2 - b**2])


def of_principal_moments(principal_moments):
    """Declare wrong principal moments of a tensor."""

    @principal_moments.mistake(
        "diagonal-only", "the diagonal of the tensor: the principal moments are its eigenvalues"
    )
    def diagonal(tensor):
        return np.diagonal(tensor).copy()

    @principal_moments.mistake(
        "wrong-quantity", "a principal axis, not the moments: np.linalg.eigh returns the eigenvalues first"
    )
    def an_axis(tensor):
        return np.linalg.eigh(tensor)[1][:, 0]

    @principal_moments.mistake(
        "wrong-quantity", "the square roots of the moments, as singular values would be"
    )
    def roots(tensor):
        return np.sqrt(principal_moments(tensor))

    @principal_moments.mistake("absolute-value", "the eigenvalues of the absolute values: the signs are lost")
    def of_absolute_values(tensor):
        return np.linalg.eigvalsh(np.abs(tensor))

    @principal_moments.mistake("sign-flipped", "the off-diagonal elements have the opposite sign")
    def off_diagonal_reversed(tensor):
        return np.linalg.eigvalsh(2 * np.diag(np.diagonal(tensor)) - tensor)


def of_euler_eqs(euler_eqs):
    """Declare wrong right-hand sides of Euler's equations."""
    for k, (old, new) in enumerate((("I2 - I3", "I3 - I2"), ("I3 - I1", "I1 - I3"), ("I1 - I2", "I2 - I1"))):
        difference = f"({MOMENT[(k + 1) % 3]} − {MOMENT[(k + 2) % 3]})"
        euler_eqs.mistake(
            "sign-flipped",
            f"{RATE[k]} has the opposite sign: check {difference}",
            change=f"({old}) -> ({new})",
        )
    _of_orders(euler_eqs)
    _of_indices(euler_eqs)
    _of_constants(euler_eqs)
    _of_functions(euler_eqs)


def _of_orders(euler_eqs):
    @euler_eqs.mistake(
        "component-order",
        lambda order: f"the components are returned in the wrong order: {named(RATE, order)}",
        order=ORDERS,
    )
    def returned_in_another_order(t, w, I, order):
        return np.asarray(euler_eqs(t, w, I))[list(order)]

    @euler_eqs.mistake(
        "moment-order",
        lambda order: (
            f"the moments are used in the order {named(MOMENT, order)}: use them in the given order"
        ),
        order=ORDERS,
    )
    def moments_in_another_order(t, w, I, order):
        return euler_eqs(t, w, np.asarray(I)[list(order)])

    @euler_eqs.mistake(
        "moment-order", "the moments are sorted: use I₁, I₂, I₃ in the given order", sense=(1, -1)
    )
    def sorted_moments(t, w, I, sense):
        return euler_eqs(t, w, np.sort(I)[::sense])

    @euler_eqs.mistake("swapped-arguments", "w and I are swapped: the order is euler_eqs(t, w, I)")
    def swapped(t, w, I):
        return euler_eqs(t, I, w)


def _of_indices(euler_eqs):
    @euler_eqs.mistake(
        "cyclic-order",
        lambda of: (
            f"the product is ω{PLACES[of[0]]}·ω{PLACES[of[1]]} instead of ωⱼ·ωₖ: check the cyclic order"
        ),
        of=((0, 1), (0, 2), (0, 0), (1, 1), (2, 2)),
    )
    def another_product(t, w, I, of):
        return (np.roll(I, -1) - np.roll(I, -2)) * np.roll(w, -of[0]) * np.roll(w, -of[1]) / I

    @euler_eqs.mistake(
        "cyclic-order",
        lambda of: (
            f"the difference is (I{PLACES[of[0]]} − I{PLACES[of[1]]}) instead of (Iⱼ − Iₖ): check the order"
        ),
        of=((0, 1), (1, 0), (0, 2), (2, 0)),
    )
    def another_difference(t, w, I, of):
        return (np.roll(I, -of[0]) - np.roll(I, -of[1])) * np.roll(w, -1) * np.roll(w, -2) / I

    @euler_eqs.mistake(
        "wrong-divisor",
        lambda of: f"the divisor is I{PLACES[of]} instead of the component's own moment",
        of=(1, 2),
    )
    def another_divisor(t, w, I, of):
        return euler_eqs(t, w, I) * I / np.roll(I, -of)

    @euler_eqs.mistake("wrong-divisor", "it is divided by its moment twice")
    def divided_twice(t, w, I):
        return euler_eqs(t, w, I) / I

    @euler_eqs.mistake("wrong-divisor", "it is multiplied by its moment instead of divided")
    def multiplied(t, w, I):
        return euler_eqs(t, w, I) * I**2

    @euler_eqs.mistake("wrong-divisor", "the divisor is I₁ + I₂ + I₃ instead of the component's own moment")
    def divided_by_the_sum(t, w, I):
        return euler_eqs(t, w, I) * I / np.sum(I)

    @euler_eqs.mistake("wrong-divisor", "the divisor is |I| instead of the component's own moment")
    def divided_by_the_norm(t, w, I):
        return euler_eqs(t, w, I) * I / np.linalg.norm(I)

    @euler_eqs.mistake("missing-division", "it is not divided by its moment: the result is a torque, not ω̇")
    def torque(t, w, I):
        return euler_eqs(t, w, I) * I

    @euler_eqs.mistake("moment-sum", "the sum of two moments stands in place of their difference")
    def sum_of_moments(t, w, I):
        return (np.roll(I, -1) + np.roll(I, -2)) * np.roll(w, -1) * np.roll(w, -2) / I

    @euler_eqs.mistake("missing-term", "one moment stands in place of the difference of two")
    def first_moment_alone(t, w, I):
        return np.roll(I, -1) * np.roll(w, -1) * np.roll(w, -2) / I


def _of_constants(euler_eqs):
    @euler_eqs.mistake(
        "hard-coded-moments",
        "the moments are always those of {where}: the argument I is ignored",
        where=BODIES,
    )
    def of_one_body(t, w, I, where):
        return euler_eqs(t, w, np.array(BODIES[where]))

    @euler_eqs.mistake(
        "hard-coded-moments", "the differences of moments are always those of {where}", where=BODIES
    )
    def differences_of_one_body(t, w, I, where):
        return euler_eqs(t, w, np.array(BODIES[where])) * np.array(BODIES[where]) / I

    @euler_eqs.mistake("hard-coded-moments", "the divisors are always the moments of {where}", where=BODIES)
    def divisors_of_one_body(t, w, I, where):
        return euler_eqs(t, w, I) * I / np.array(BODIES[where])

    @euler_eqs.mistake("clipped", "it is limited to ±{limit}", limit=(1, 2, 3, 5, 10, 20, 50, 100))
    def limited(t, w, I, limit):
        return np.clip(euler_eqs(t, w, I), -limit, limit)

    @euler_eqs.mistake(
        "precision-loss",
        "too few digits: ω and I are converted to {how}",
        how=("float32", "float16", "int64"),
    )
    def converted(t, w, I, how):
        w, I = (np.asarray(x).astype(how).astype(float) for x in (w, I))
        return euler_eqs(t, w, I)

    @euler_eqs.mistake("precision-loss", "the answer is cut to whole numbers: look for an array of integers")
    def whole_numbers(t, w, I):
        return np.trunc(euler_eqs(t, w, I))


def _of_functions(euler_eqs):
    @euler_eqs.mistake("returns-input", "it is L = Iω itself instead of the rate of change of ω")
    def momentum(t, w, I):
        return I * w

    @euler_eqs.mistake("normalised", "it is computed from the unit vector ω/|ω|: use ω itself")
    def of_the_direction(t, w, I):
        return euler_eqs(t, w, I) / max(np.sum(w**2), 1e-300)

    @euler_eqs.mistake("normalised", "a factor |ω| is missing: one of its ω comes from a unit vector")
    def of_one_direction(t, w, I):
        return euler_eqs(t, w, I) / max(np.linalg.norm(w), 1e-150)

    @euler_eqs.mistake("inverted-moments", "I and 1/I are swapped: use (Iⱼ − Iₖ)/Iᵢ")
    def of_inverse_moments(t, w, I):
        return euler_eqs(t, w, 1 / I)

    @euler_eqs.mistake("absolute-value", "the absolute value of the whole result is taken: its sign is lost")
    def absolute(t, w, I):
        return np.abs(euler_eqs(t, w, I))

    @euler_eqs.mistake("absolute-value", "the absolute value of the difference (Iⱼ − Iₖ) is taken")
    def absolute_difference(t, w, I):
        return np.abs(np.roll(I, -1) - np.roll(I, -2)) * np.roll(w, -1) * np.roll(w, -2) / I

    @euler_eqs.mistake("floor-division", "floor division (//) drops the fraction: divide with /")
    def floor_of_the_moments(t, w, I):
        return (np.roll(I, -1) - np.roll(I, -2)) // I * np.roll(w, -1) * np.roll(w, -2)

    @euler_eqs.mistake("floor-division", "floor division (//) drops the fraction of the result")
    def floor(t, w, I):
        return np.floor(euler_eqs(t, w, I))

    @euler_eqs.mistake("missing-brackets", "only the second moment is divided: the difference needs brackets")
    def second_divided(t, w, I):
        return (np.roll(I, -1) - np.roll(I, -2) / I) * np.roll(w, -1) * np.roll(w, -2)

    @euler_eqs.mistake("wrong-power", "the squares of ω stand in place of ω")
    def squared_spin(t, w, I):
        return euler_eqs(t, w**2, I)

    @euler_eqs.mistake(
        "wrong-power", "the difference of the squares of the moments stands in place of (Iⱼ − Iₖ)"
    )
    def squared_moments(t, w, I):
        return euler_eqs(t, w, I) * (np.roll(I, -1) + np.roll(I, -2))

    @euler_eqs.term("proportional to ω, such as damping")
    def damping(w):
        return w

    @euler_eqs.term("proportional to |ω|ω over the moment, such as drag")
    def drag(w, I):
        return np.linalg.norm(w, axis=-1, keepdims=True) * w / I

    @euler_eqs.term("proportional to |ω|ω")
    def drag_of_the_rate(w):
        return np.linalg.norm(w, axis=-1, keepdims=True) * w

    @euler_eqs.term("proportional to ω over the moment")
    def damping_torque(w, I):
        return w / I

    @euler_eqs.term("of a constant torque")
    def torque(I):
        return 1 / I

    @euler_eqs.term("that is constant")
    def constant(w):
        return np.ones_like(w)


def of_precession_rate(precession_rate):
    """Declare wrong precession rates."""
    jumps = "the phase jumps by 2π and is not unwrapped before its slope is taken: see np.unwrap"
    sines = "arcsin gives angles up to a quarter of a turn only: use arctan2(ω₂, ω₁), and np.unwrap"

    @precession_rate.mistake("not-unwrapped", jumps, mean=MEANS)
    def not_unwrapped(t, w, mean):
        return _mean(mean, t, np.arctan2(w[1], w[0]))

    @precession_rate.mistake(
        "wrong-components",
        lambda of, mean: (
            f"the phase of {SPIN[of[0]]} and {SPIN[of[1]]} is used: the precession turns (ω₁, ω₂)"
        ),
        of=((2, 0), (0, 2), (2, 1), (1, 2)),
        mean=MEANS,
    )
    def of_other_components(t, w, of, mean):
        return _mean(mean, t, np.unwrap(np.arctan2(w[of[0]], w[of[1]])))

    @precession_rate.mistake(
        "not-unwrapped",
        "arctan does not distinguish quadrants: use arctan2(ω₂, ω₁), and np.unwrap",
        mean=MEANS,
    )
    def of_a_quotient(t, w, mean):
        return _mean(mean, t, np.unwrap(np.arctan(w[1] / w[0])))

    @precession_rate.mistake(
        "not-unwrapped",
        "the phase in degrees is unwrapped as if it were in radians: np.unwrap needs period=360",
        mean=MEANS,
    )
    def unwrapped_in_degrees(t, w, mean):
        return _mean(mean, t, np.radians(np.unwrap(np.degrees(np.arctan2(w[1], w[0])))))

    @precession_rate.mistake("not-unwrapped", sines)
    def quarters(t, w):
        x, y, r = w[0], w[1], np.hypot(w[0], w[1])
        sine = (x[:-1] * y[1:] - y[:-1] * x[1:]) / (r[:-1] * r[1:])
        return np.arcsin(np.clip(sine, -1, 1)).sum() / (t[-1] - t[0])

    @precession_rate.mistake(
        "wrong-times", "the time is assumed to start at zero: divide by t[-1] − t[0]", share=(1, 0)
    )
    def from_zero(t, w, share):
        phase = np.unwrap(np.arctan2(w[1], w[0]))
        return (phase[-1] - share * phase[0]) / t[-1]

    @precession_rate.mistake("wrong-times", "the angle per sample: divide by the time between samples")
    def per_sample(t, w):
        phase = np.unwrap(np.arctan2(w[1], w[0]))
        return (phase[-1] - phase[0]) / (len(t) - 1)

    @precession_rate.mistake("wrong-times", "the times are assumed to be evenly spaced: use t itself")
    def evenly(t, w):
        phase = np.unwrap(np.arctan2(w[1], w[0]))
        return np.mean(np.diff(phase)) / (t[1] - t[0])

    @precession_rate.mistake("wrong-quantity", "the period of the precession instead of its rate")
    def period(t, w):
        return 2 * np.pi / precession_rate(t, w)


MEANS = ("slope", "whole", "steps")
"""Ways to take the mean rate of a phase, which give the same number for a right phase only."""


def _mean(how, t, phase):
    if how == "slope":
        return np.polyfit(t, phase, 1)[0]
    if how == "whole":
        return (phase[-1] - phase[0]) / (t[-1] - t[0])
    return np.mean(np.gradient(phase, t))
