"""systemd as process 1 of namespaces of its own, on a copy-on-write view of this machine's files, without its
network.
"""

import os
import shutil
import subprocess
import time
from pathlib import Path

GROUP = Path("/sys/fs/cgroup/systemd")
# The view becomes the root by pivot_root: below chroot no user namespace can be made. Its /opt/polhode is a
# virtual environment with the wheel and the packages that run the tests.
BEGIN = """
set -e
echo $$ > {group}/cgroup.procs
exec unshare --mount --pid --fork --uts --ipc --cgroup --net --kill-child bash -ec '
mount --make-rprivate /
mount -t tmpfs tmpfs {folder}
mkdir {folder}/upper {folder}/work {folder}/root
mount -t overlay overlay -o lowerdir=/,upperdir={folder}/upper,workdir={folder}/work {folder}/root
cd {folder}/root
mkdir -p opt/polhode/bin opt/polhode/lib/python3.11/site-packages
mount -t overlay overlay -o lowerdir={wheel}:{venv}/lib/python3.11/site-packages \\
    opt/polhode/lib/python3.11/site-packages
ln -s /usr/bin/python3 opt/polhode/bin/python3
printf "home = /usr/bin\\ninclude-system-site-packages = false\\n" > opt/polhode/pyvenv.cfg
printf "#!/opt/polhode/bin/python3\\nimport sys\\n" > opt/polhode/bin/polhode
printf "from service.cli.__main__ import main\\nsys.exit(main())\\n" >> opt/polhode/bin/polhode
chmod 755 opt/polhode/bin/polhode
mount -t proc proc proc
mount --bind proc/sys proc/sys
mount -o remount,bind,ro proc/sys
mount -t tmpfs tmpfs run
mount -t tmpfs tmpfs dev
for device in null zero full random urandom tty; do
    touch dev/$device
    mount --bind /dev/$device dev/$device
done
mkdir dev/shm
mount -t tmpfs tmpfs dev/shm
mount -t tmpfs tmpfs sys
mkdir -p sys/fs/cgroup
mount -t tmpfs tmpfs sys/fs/cgroup
mkdir sys/fs/cgroup/systemd
mount -t cgroup -o none,name=systemd cgroup sys/fs/cgroup/systemd
ip link set lo up
rm -rf etc/systemd/system/*.wants
for unit in systemd-tmpfiles-setup systemd-sysctl systemd-modules-load systemd-tmpfiles-setup-dev; do
    ln -sf /dev/null etc/systemd/system/$unit.service
done
useradd --system --home-dir /var/lib/polhode --root $PWD polhode
cp {units}/* etc/systemd/system/
ln -sf /lib/systemd/system/basic.target etc/systemd/system/default.target
mkdir -p opt/former
pivot_root . opt/former
exec env -i container=other PATH=/usr/local/bin:/usr/bin:/usr/sbin:/bin \\
    sh -c "umount -l /opt/former; exec /lib/systemd/systemd --show-status=0"
'
"""


def is_possible() -> bool:
    """Whether this machine lets systemd run in namespaces: as root, with its cgroup of version 1 and Debian's
    Python 3.11.
    """
    programs = all(map(shutil.which, ("unshare", "nsenter", "pivot_root", "ip", "useradd")))
    python = Path("/usr/bin/python3.11").exists()
    return (
        os.geteuid() == 0 and GROUP.is_dir() and Path("/lib/systemd/systemd").exists() and programs and python
    )


class Machine:
    """A machine with polhode in /opt/polhode and the units; ``machine(…)`` runs a command there and returns
    what it prints.
    """

    def __init__(self, folder: Path, venv: Path, wheel: Path, units: Path) -> None:
        self._group = GROUP / f"polhode-{os.getpid()}"
        self._group.mkdir()
        script = BEGIN.format(folder=folder, venv=venv, wheel=wheel, units=units, group=self._group)
        self._process = subprocess.Popen(["bash", "-c", script], stderr=subprocess.PIPE, text=True)
        self._first = self._wait_for_first()

    def _wait_for_first(self) -> int:
        children = Path(f"/proc/{self._process.pid}/task/{self._process.pid}/children")
        for _ in range(300):
            assert self._process.poll() is None, self._process.stderr.read()
            for child in children.read_text().split():
                if Path(f"/proc/{child}/comm").read_text().strip() == "systemd":
                    return int(child)
            time.sleep(0.1)
        raise AssertionError("systemd did not start")

    def __call__(self, *command: str, check: bool = True) -> str:
        enter = ["nsenter", "--target", str(self._first), "--all", "--root", "--wd", *command]
        done = subprocess.run(
            enter, env={"PATH": "/usr/bin:/usr/sbin:/bin"}, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0 or not check, f"{command}: {done.stdout[-2000:]}\n{done.stderr[-2000:]}"
        return done.stdout

    def wait(self, *command: str, seconds: float = 60.0) -> None:
        """Run a command until it ends with 0."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            enter = ["nsenter", "--target", str(self._first), "--all", "--root", "--wd", *command]
            if subprocess.run(enter, capture_output=True, check=False).returncode == 0:
                return
            time.sleep(0.3)
        raise AssertionError(
            f"{command} failed for {seconds:g} s:"
            f" {self('journalctl', '--no-pager', '--lines=20', check=False)}"
        )

    def end(self) -> None:
        """End every process of the machine and remove its cgroup."""
        os.kill(self._first, 9)
        self._process.wait(20)
        self._process.stderr.close()
        for _ in range(50):
            for folder, _, _ in os.walk(self._group, topdown=False):
                try:
                    os.rmdir(folder)
                except OSError:
                    break
            if not self._group.exists():
                return
            time.sleep(0.1)
