"""A generator."""


# ends: fail
def euler_eqs(t, w, I):
    return (x for x in (1, 2, 3))
