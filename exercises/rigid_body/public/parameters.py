"""The bodies and spins of notebook 2.6, in SI units."""

BOX = (1.0, 2.0, 1.4, 0.4)  # mass and edges of the book, kg and m
SPIN = 6.0  # rad/s about each axis of the book in turn
SPIN_TIME = 2.5  # s
NUDGE = 0.02  # both other components, as a fraction of the spin
BODY = (2.0, 3.0, 4.0)  # moments of exercises 2 and 3
TORQUE_FREE = (1.0, 0.6, 0.8)  # and their spin: T = 2.82 J, |L| = 4.180909 kg m²/s
SYMMETRIC = (1.0, 1.0, 1.6)  # moments of exercises 4 and 6
SYMMETRIC_RATE = 1.8  # rad/s, (I₃ − I₁)/I₁ · ω₃ with ω₃ = 3
