"""A text that doubles."""

# ends: fail
text = "x"
while True:
    text += text
