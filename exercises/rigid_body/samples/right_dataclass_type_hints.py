from dataclasses import dataclass


@dataclass(frozen=True)
class Moments:
    A: float
    B: float
    C: float

    @property
    def ratios(self) -> np.ndarray:
        return np.array([(self.B - self.C) / self.A, (self.C - self.A) / self.B, (self.A - self.B) / self.C])


def euler_eqs(t: float, w: np.ndarray, I: tuple[float, float, float]) -> np.ndarray:
    p, q, r = w
    body: Moments = Moments(*I)
    return body.ratios * np.array([q * r, r * p, p * q])
