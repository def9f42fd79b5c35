"""A report as other systems read it. Pure: no HTTP, no SQL, no clock."""
