# trick: Im (x + iy)^2 = 2xy gives all the products of two components
def euler_eqs(t, w, I):
    z = np.array([w[1] + 1j * w[2], w[2] + 1j * w[0], w[0] + 1j * w[1]])
    products = (z * z).imag / 2
    k = np.array([(I[1] - I[2]) / I[0], (I[2] - I[0]) / I[1], (I[0] - I[1]) / I[2]])
    return k * products
