def euler_eqs(t, w, I):
    low, mid, high = sorted(I)
    return np.array([(mid - high) * w[1] * w[2] / low, (high - low) * w[2] * w[0] / mid, (low - mid) * w[0] * w[1] / high])
