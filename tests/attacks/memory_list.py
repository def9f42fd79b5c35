"""A list without end."""

# ends: fail
grown = []
while True:
    grown.append([0] * 100)
