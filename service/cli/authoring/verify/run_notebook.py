"""A program for ``polhode verify``: run a published notebook with each of several solutions and print what
``polhode.check`` finds.

It runs apart from polhode, with the students' kit. Arguments: the folder of the kit, and a JSON file with the
notebook's ``statements`` (source, cell number, whether it defines a solution) and the ``samples`` (name,
source and exercises). Prints a line of JSON for each sample: the verdict and line of each check by its id, or
the ``error`` that a cell raised.
"""

import contextlib
import io
import json
import os
import sys
import types
from typing import Any


def main() -> None:
    """Run the notebook for each sample."""
    kit, job = sys.argv[1:]
    sys.path.insert(0, kit)
    os.environ["MPLBACKEND"] = "agg"
    with open(job, encoding="utf-8") as file:
        document = json.load(file)
    import polhode

    polhode.connect(assignment=document["slug"])  # which is in the kit's cache
    for sample in document["samples"]:
        print(json.dumps(_run(document["statements"], document["slug"], sample)), flush=True)


def _run(statements: list[dict[str, Any]], slug: str, sample: dict[str, Any]) -> dict[str, Any]:
    """Run the statements, the sample in place of those that define a solution, and check its exercises."""
    import polhode

    module = sys.modules["__main__"] = types.ModuleType("__main__")
    names = vars(module)
    names["polhode"] = polhode  # as the cell that installs the kit imports it
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        place = ""
        try:
            for statement in statements:
                place = statement["cell"]
                exec(
                    compile(
                        sample["source"] if statement["solution"] else statement["source"], place, "exec"
                    ),
                    names,
                )
            place = "polhode.check"
            names["slug"], names["asked"] = slug, sample["ask"]
            exec("report = polhode.check(*asked, assignment=slug)", names)
        except BaseException as error:
            return {"error": f"{place}: {type(error).__name__}: {error}"}
    return {outcome.id: [outcome.verdict, outcome.line] for outcome in names["report"].outcomes()}


if __name__ == "__main__":
    main()
