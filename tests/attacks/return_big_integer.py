"""Integers beyond any float."""


# ends: fail
def euler_eqs(t, w, I):
    return [10**400, 1, 1]
