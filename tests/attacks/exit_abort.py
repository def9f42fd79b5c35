"""Aborts."""

# ends: fail
import os

os.abort()
