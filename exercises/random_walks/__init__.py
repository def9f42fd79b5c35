"""Random walks and Monte Carlo: seven exercises."""
