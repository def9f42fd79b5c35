"""The cells that define a function: those of a notebook that need not run again when only the function is asked."""

from collections.abc import Collection, Iterable

from ecp.notebook.names import names_in


def needed_sources(sources: Iterable[str], names: Collection[str]) -> set[str]:
    """Return the sources that bind one of ``names`` or of the names that such sources use.

    Those that are no valid Python and those that import * are among them, as their names are not known. A source that changes an
    object without binding its name is left out.
    """
    found = {source: names_in(source) for source in sources}
    needed = {source for source, its in found.items() if "import *" in source or not its.bound | its.now | its.later}
    wanted, grown = set(names), True
    while grown:
        more = {source for source, its in found.items() if its.bound & wanted} - needed
        wanted |= {name for source in needed | more for name in found[source].now | found[source].later}
        needed, grown = needed | more, bool(more)
    return needed
