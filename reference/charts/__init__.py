"""Charts of the methods: what accuracy costs, where methods fail, and the least model that a scene needs."""
