"""The hidden checks, added to the public ones."""

from polhode.judging.checks import within

RATES = within(
    "1-rates",
    "oscillator is (v, −ω²x − 2γv) for any state, ω and γ",
    "probes",
    measured=lambda seen: seen["rate"],
    expected=lambda truth: truth["rate"],
    scale=lambda truth: truth["scale"],
    limit=1e-13,
    reason=(
        "of ω²|x| + 2γ|v|: correct formulas differ by a few roundings of 2.2e-16; the limit is over 100 times"
        " that"
    ),
    locate=lambda index, seen: f"{('dx/dt', 'dv/dt')[index[1]]}, probe {index[0] + 1} of {len(seen['rate'])}",
)
