"""Reports and grades in the formats of other systems: pure functions without HTTP, SQL or a clock."""
