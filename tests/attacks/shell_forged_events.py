"""Says that other statements run, that they are over, and that names are defined, then ends."""

# ends: fail
import json
import os
import struct

get_ipython()
for event in (
    {"event": "statement", "cell": "submission.py", "line": 10**9, "column": 0},
    {"event": "stopped", "sentence": "x" * 5000},
    {"event": "defined", "names": ["euler_eqs"], "missing": [], "claims_left_out": 0},
    {"event": "statement", "cell": "submission.py", "line": 1, "column": 0},
):
    body = json.dumps(event).encode()
    os.write(RESULT, struct.pack("<cI", b"J", len(body)) + body)
os._exit(0)
