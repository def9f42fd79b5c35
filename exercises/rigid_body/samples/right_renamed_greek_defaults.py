def euler_eqs(time, ω, moments, torque=(0.0, 0.0, 0.0)):
    Θ1, Θ2, Θ3 = moments
    M1, M2, M3 = torque
    return np.array([
        ((Θ2 - Θ3) * ω[1] * ω[2] + M1) / Θ1,
        ((Θ3 - Θ1) * ω[2] * ω[0] + M2) / Θ2,
        ((Θ1 - Θ2) * ω[0] * ω[1] + M3) / Θ3,
    ])
