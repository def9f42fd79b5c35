"""Commands that grade files without a server, also within other systems."""
