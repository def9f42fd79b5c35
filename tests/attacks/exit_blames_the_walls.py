"""Ends with the exit code of walls that could not be put up."""

# ends: fail
import os

print("no walls")
os._exit(97)
