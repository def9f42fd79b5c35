"""Reports and grades in the formats of other systems. Pure: no HTTP, no SQL, no clock."""
