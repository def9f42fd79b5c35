"""No motion: nothing is conserved better."""


# ends: fail
def euler_eqs(t, w, I):
    return [0.0, 0.0, 0.0]
