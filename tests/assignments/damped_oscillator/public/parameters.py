"""The parameters of the public scenes, in SI units."""

START = (1.0, 0.0)  # x and v at t = 0
DAMPED = (2.0, 0.1)  # ω and γ
UNDAMPED = (2.0, 0.0)
T_END, N = 20.0, 401  # 40 rad
