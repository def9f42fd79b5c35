"""A notebook's text without what grading does not read, such as the pictures in its outputs.

Kit and server strip a notebook by this same function, so the server stores exactly the text that the kit
sent.
"""

import json
import re
from typing import Any

NOTEBOOK_FIELDS = ("cells", "metadata", "nbformat", "nbformat_minor")
METADATA = ("kernelspec", "language_info")  # by which Jupyter chooses the kernel
CELL_FIELDS = ("cell_type", "execution_count", "id", "metadata", "outputs", "source")
EMPTY: dict[str, Any] = {"metadata": {}, "outputs": []}
_LONE_SURROGATE = re.compile("[\ud800-\udfff]")  # JSON has it as an escape; UTF-8 cannot encode it


def is_notebook(text: str, filename: str) -> bool:
    """Return whether a file is a notebook: by its name, or by its text whatever its name is."""
    if filename.lower().endswith(".ipynb"):
        return True
    if not text.lstrip().startswith("{"):
        return False
    try:
        return isinstance(json.loads(text).get("cells"), list)
    except (ValueError, RecursionError):
        return False


def strip_outputs(text: str) -> str:
    """Return a notebook without outputs, attachments and metadata; the same text if it has none of them.

    Cells keep their source, number and id, the notebook keeps its kernel. Raises ValueError if the text is
    not a notebook of format 4.
    """
    try:
        notebook = json.loads(text)
        cells = [
            {name: EMPTY.get(name, cell[name]) for name in cell if name in CELL_FIELDS}
            for cell in notebook["cells"]
        ]
        stripped = {name: notebook[name] for name in notebook if name in NOTEBOOK_FIELDS} | {"cells": cells}
        if metadata := notebook.get("metadata"):
            stripped["metadata"] = {name: metadata[name] for name in metadata if name in METADATA}
        if stripped == notebook:
            return text
        written = json.dumps(stripped, ensure_ascii=False, indent=1)
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError):
        raise ValueError("this is not a Jupyter notebook (format 4)") from None
    return _LONE_SURROGATE.sub(lambda found: f"\\u{ord(found[0]):04x}", written) + "\n"
