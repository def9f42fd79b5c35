def euler_eqs(t, w, I):
    I1, I2, I3 = I
    ramp = np.tanh(5 * t)          # smooth start
    w1, w2, w3 = w
    return ramp * np.array([(I2 - I3)*w2*w3/I1, (I3 - I1)*w3*w1/I2, (I1 - I2)*w1*w2/I3])
