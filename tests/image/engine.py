"""podman with storage, networks and settings of its own in a temporary folder,
so that nothing stays behind.
"""

import json
import os
import resource
import shutil
import subprocess
from pathlib import Path

STORAGE = '[storage]\ndriver = "overlay"\ngraphroot = "{home}/storage"\nrunroot = "{home}/run"\n'
OWN = '[network]\nnetwork_config_dir = "{home}/networks"\ndefault_subnet = "10.213.0.0/24"\n'
ENGINE = '[engine]\nlock_type = "file"\nevents_logger = "file"\n'
# Where cgroups are of both versions crun does nothing, and a machine's own limits may be lower than what
# podman asks for.
OLDER = (
    '{engine}runtime = "runc"\n[containers]\n'
    'default_ulimits = ["nofile={files}:{files}", "nproc={tasks}:{tasks}"]\n'
)
# What Docker's profile keeps from a container without CAP_SYS_ADMIN, and podman's does not.
NAMESPACES = {
    "clone",
    "clone3",
    "unshare",
    "setns",
    "mount",
    "umount",
    "umount2",
    "pivot_root",
    "move_mount",
    "mount_setattr",
}
NAMESPACES |= {"open_tree", "fsopen", "fsconfig", "fsmount", "fspick"}
NEW_NAMESPACE = 0x7E020000  # the flags CLONE_NEW*


class Failed(Exception):
    """What was tried did not work; the message says what was seen."""


class Podman:
    """``podman(…)`` runs a command; ``end`` removes all there is."""

    def __init__(self, home: Path) -> None:
        self.home = home
        own = {
            "CONTAINERS_CONF": f"{home}/containers.conf",
            "CONTAINERS_STORAGE_CONF": f"{home}/storage.conf",
        }
        self.environment = os.environ | own
        (home / "storage.conf").write_text(STORAGE.format(home=home))
        self._configure(ENGINE)

    def __call__(
        self, *words: str, seconds: float = 120, program: str = "podman", sent: str | None = None
    ) -> str:
        """What it prints; Failed where it ends with another code than 0 or not in time."""
        try:
            told = subprocess.run(
                [program, *words],
                env=self.environment, cwd=self.home, input=sent, capture_output=True, text=True,
                    timeout=seconds, check=False,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            raise Failed(f"{program} {' '.join(words)[:200]} took longer than {seconds:g} s") from None
        if told.returncode != 0:
            raise Failed(
                f"{program} {' '.join(words)[:200]} ended with {told.returncode}:\n"
                f"{(told.stdout + told.stderr)[-4000:]}"
            )
        return told.stdout

    def works(self, *words: str) -> bool:
        """Whether the command ends with 0."""
        try:
            self(*words)
        except Failed:
            return False
        return True

    def adapt(self, image: str) -> str:
        """Find settings under which containers run on this machine; which they are."""
        if self.works("run", "--rm", image, "true"):
            return "podman as it is"
        most = {"files": resource.RLIMIT_NOFILE, "tasks": resource.RLIMIT_NPROC}
        limits = {name: min(resource.getrlimit(which)[1], 4096) % (1 << 62) for name, which in most.items()}
        self._configure(OLDER.format(engine=ENGINE, **limits))
        self("run", "--rm", image, "true")
        return f"podman with runc and limits {limits}"

    def profile(self) -> Path:
        """A seccomp profile as strict about namespaces as Docker's default one, made from podman's."""
        path = self.home / "docker-like.json"
        profile = json.loads(
            Path(self("info", "--format", "{{.Host.Security.SECCOMPProfilePath}}").strip()).read_text()
        )
        for rule in profile["syscalls"]:
            rule["names"] = [name for name in rule["names"] if name not in NAMESPACES]
        masked = {"index": 0, "value": NEW_NAMESPACE, "valueTwo": 0, "op": "SCMP_CMP_MASKED_EQ"}
        profile["syscalls"] = [rule for rule in profile["syscalls"] if rule["names"]]
        profile["syscalls"].append({"names": ["clone"], "action": "SCMP_ACT_ALLOW", "args": [masked]})
        profile["syscalls"].append(
            {"names": sorted(NAMESPACES - {"clone", "clone3"}), "action": "SCMP_ACT_ERRNO", "errnoRet": 1}
        )
        path.write_text(json.dumps(profile))
        return path

    def end(self) -> None:
        """Remove containers, volumes, networks, images and the folder."""
        for kind in ("rm --all --volumes --time 5", "volume rm --all", "network prune", "rmi --all"):
            self.works(*kind.split(), "--force")
        shutil.rmtree(self.home)

    def _configure(self, engine: str) -> None:
        (self.home / "containers.conf").write_text(OWN.format(home=self.home) + engine)
