"""Everything that crosses the wall: standard library, numpy, scipy, matplotlib and the kit, nothing else of ours."""
