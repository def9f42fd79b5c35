"""Errors for whoever sits at the notebook."""


class Explained(Exception):
    """Its text says what happened and what to do; IPython shows that sentence and no traceback."""

    def _render_traceback_(self) -> list[str]:
        return [str(self)]
