"""A list without end."""

# ends: fail slow
grown = []
while True:
    grown.append([0] * 100)
