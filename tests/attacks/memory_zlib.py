"""A decompression bomb."""

# ends: fail slow
import zlib

packed = zlib.compress(b"0" * (1 << 27), 9)
unpacked = []
while True:
    unpacked.append(zlib.decompress(packed))
