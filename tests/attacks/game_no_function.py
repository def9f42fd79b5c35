"""The name is there and cannot be called."""

# ends: fail
euler_eqs = "euler_eqs"
