"""The likely cause of each ✗: what wrong numbers show, and which wrong solution returns them."""
