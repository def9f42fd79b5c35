"""The cells of a submission: how they are found, how they run, and what they call."""
