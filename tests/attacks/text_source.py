"""Form feeds, a coding cookie and bidirectional controls in the source."""
# ends: pass
# -*- coding: utf-8 -*-

# ‮ } ⁦ if euler ⁩ ⁦
