# Homework 2.6, translated from my MATLAB script eulerEqs.m
def euler_eqs(t, w, I):
    dw = np.zeros((3, 1));
    w1 = w[0]; w2 = w[1]; w3 = w[2];
    I1 = I[0]; I2 = I[1]; I3 = I[2];

    dw[0, 0] = (I2 - I3) / I1 * w2 * w3;
    dw[1, 0] = (I3 - I1) / I2 * w3 * w1;
    dw[2, 0] = (I1 - I2) / I3 * w1 * w2;

    dw = dw[:, 0];   # solve_ivp does not like columns
    return dw;
# end
