"""Users, host name, logs and folders."""

# ends: pass
import os

for path in ("/etc/passwd", "/etc/shadow", "/etc/hostname", "/root/.bashrc", "/var/log/dpkg.log", "/etc/resolv.conf"):
    attempt(path, lambda: open(path).read(50))
for folder in ("/", "/etc", "/root", "/home", "/tmp", "/dev"):
    attempt(f"list {folder}", lambda: os.listdir(folder))
