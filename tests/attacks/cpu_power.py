"""One C call that never comes back."""


# ends: fail slow
def euler_eqs(t, w, I):
    return 10 ** (10**9)
