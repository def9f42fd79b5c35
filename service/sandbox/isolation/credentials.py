"""The user, groups and capabilities that a guest reports, and whether polhode may grade with them."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.sandbox.isolation.levels import Isolation

REMEDIES = (
    "make the Python environment and polhode's files readable for every user (chmod -R o+rX), run polhode as"
    " an ordinary user, or set POLHODE_ALLOW_ROOT_GUEST=true to accept a weaker sandbox"
)
ROOT_ALLOWED = (
    "POLHODE_ALLOW_ROOT_GUEST is set: submissions run as root (%s) and can learn which files of root exist. "
    "Unset it once the guest can change to another user"
)


@dataclass(frozen=True)
class Identity:
    """The ``users`` and ``groups`` (real, effective, saved; then supplementary groups) and ``capabilities``
    of a guest.
    """

    users: Sequence[int]
    groups: Sequence[int]
    capabilities: Sequence[int]

    @property
    def is_root(self) -> bool:
        """Whether one of the guest's user ids is root's."""
        return 0 in self.users

    def refusal(self, isolation: Isolation) -> str:
        """Return why polhode must not grade with this guest, and what to do, or an empty string if it may."""
        if self.capabilities:
            held = ", ".join(map(str, self.capabilities))
            return (
                f"the sandbox is not secure: the guest kept the capabilities {held}. Report this as a defect"
                " of polhode"
            )
        if self.is_root and not isolation.allow_root:
            why = isolation.stays_root or "it did not change its user"
            return (
                f"the sandbox is not secure: submissions would run as root, because {why}. Do one of these:"
                f" {REMEDIES}"
            )
        return ""

    def __str__(self) -> str:
        """Return the identity as ``polhode doctor`` shows it."""
        users, groups = (", ".join(map(str, dict.fromkeys(ids))) for ids in (self.users, self.groups))
        held = ", ".join(map(str, self.capabilities)) or "none"
        return f"user {users}{' (root)' if self.is_root else ''}, groups {groups}, capabilities {held}"
