from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field


class DynamicalSystem(ABC):
    @abstractmethod
    def derivative(self, time: float, state: np.ndarray) -> np.ndarray: ...


@dataclass(frozen=True)
class InertiaTensor:
    principal: tuple[float, ...]

    def __matmul__(self, omega):
        return np.array([moment * x for moment, x in zip(self.principal, omega)])

    @property
    def inverse(self) -> InertiaTensor:
        return InertiaTensor(tuple(1.0 / moment for moment in self.principal))


@dataclass
class FreeRigidBody(DynamicalSystem):
    inertia: InertiaTensor
    history: list = field(default_factory=list, repr=False)

    def angular_momentum(self, omega):
        return self.inertia @ omega

    def torque_in_body_frame(self, omega):
        return -np.cross(omega, self.angular_momentum(omega))

    def derivative(self, time, state):
        return self.inertia.inverse @ self.torque_in_body_frame(state)


def euler_eqs(t: float, w: np.ndarray, I: np.ndarray) -> np.ndarray:
    """Adapter between the OO model and solve_ivp."""
    return FreeRigidBody(InertiaTensor(tuple(I))).derivative(t, w)
