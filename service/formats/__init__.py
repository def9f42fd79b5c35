"""Reports and grades in the formats of other systems: pure functions without HTTP, SQL or a clock."""

VISIBLE = "visible"
VISIBILITIES = (VISIBLE, "after_due_date", "after_published", "hidden")
"""The visibilities of a test on Gradescope."""
