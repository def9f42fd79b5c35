# Exercise 2
# w in the body frame, I = (I1, I2, I3)
# I dw/dt = (I w) x w

euler_eqs = lambda t, w, I: np.cross(np.multiply(I, w), w) / np.array(I)
