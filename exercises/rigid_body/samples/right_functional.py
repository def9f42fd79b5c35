from functools import reduce
from itertools import cycle, islice, starmap
from operator import mul, sub, truediv


def rotated(xs, n):
    return islice(cycle(xs), n, n + 3)


def product(*xs):
    return reduce(mul, xs)


def euler_eqs(t, w, I):
    differences = starmap(sub, zip(rotated(I, 1), rotated(I, 2)))
    torques = map(product, differences, rotated(w, 1), rotated(w, 2))
    return np.fromiter(map(truediv, torques, I), dtype=float)
