"""Imports the answers by their names."""

# ends: pass
import importlib

for name in ("reference", "exercises", "exercises.rigid_body.draws", "service", "service.grading.grade", "tests", "polhode.secret"):
    attempt(name, lambda: importlib.import_module(name))
import sys

if any(name.split(".")[0] in ("reference", "exercises", "service", "fastapi", "sqlalchemy") for name in sys.modules):
    print("ESCAPED an answer was imported")
