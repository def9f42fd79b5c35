from math import atan2, pi


def euler_eqs(t, w, I):
    return [(I[1] - I[2]) * w[1] * w[2] / I[0],
            (I[2] - I[0]) * w[2] * w[0] / I[1],
            (I[0] - I[1]) * w[0] * w[1] / I[2]]


def precession_rate(t, w):
    phase, jumps, last = [], 0, None
    for x, y in zip(w[0], w[1]):
        p = atan2(y, x)
        if last is not None:
            if p - last > pi:
                jumps -= 1
            elif p - last < -pi:
                jumps += 1
        last = p
        phase.append(p + 2 * pi * jumps)
    # least squares slope
    n = len(t)
    tm, pm = sum(t) / n, sum(phase) / n
    return sum((a - tm) * (b - pm) for a, b in zip(t, phase)) / sum((a - tm) ** 2 for a in t)
