"""Ends its process with the exit code of success."""

# ends: fail
import os

os._exit(0)
