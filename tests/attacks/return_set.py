"""A set."""


# ends: fail
def euler_eqs(t, w, I):
    return {1, 2, 3}
