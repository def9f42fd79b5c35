"""Ends with the exit code of a sandbox that could not be set up."""

# ends: fail
import os

print("no sandbox")
os._exit(97)
