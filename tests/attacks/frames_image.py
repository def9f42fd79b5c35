"""Sends an SVG with a script in the place of pixels."""

# ends: fail film
import json
import os
import struct

svg = b"<svg xmlns='http://www.w3.org/2000/svg' onload='alert(1)'/>"
head = json.dumps({"scene": "film", "name": "frames", "shape": [60000, 60000, 60000, 3]}).encode()
body = struct.pack("<H", len(head)) + head + svg
os.write(RESULT, struct.pack("<cI", b"A", len(body)) + body)
os._exit(0)
