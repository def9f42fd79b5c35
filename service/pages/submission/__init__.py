"""The page of one submission: report, source, feedback and overrides."""
