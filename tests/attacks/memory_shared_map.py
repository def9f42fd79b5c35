"""Two gigabytes of shared anonymous memory."""

# ends: fail
import mmap

area = mmap.mmap(-1, 2 << 30)
for i in range(0, 2 << 30, 1 << 20):
    area[i] = 1
print("ESCAPED")
