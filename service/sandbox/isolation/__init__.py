"""How much a guest is separated from the host: the levels, what each needs, and which this machine has."""
