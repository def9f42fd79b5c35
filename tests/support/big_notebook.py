"""A notebook as Jupyter saves it after its cells have drawn: pictures in outputs, attachments and widgets."""

import json

PICTURE = "iVBORw0KGgo" + "A" * 600_000


def with_outputs(notebook, picture=PICTURE):
    """The bytes of the notebook (its bytes) with that picture in each code cell, attachments, tags and the
    state of widgets.
    """
    document = json.loads(notebook)
    drawn = {
        "output_type": "display_data",
        "metadata": {},
        "data": {"image/png": picture, "text/plain": ["<Figure>"]},
    }
    for number, cell in enumerate(document["cells"], start=1):
        cell["metadata"] = {"tags": ["mine"], "collapsed": False}
        if cell["cell_type"] == "code":
            cell |= {
                "outputs": [drawn, {"output_type": "stream", "name": "stdout", "text": ["1\n", "2\n"]}],
                "execution_count": number,
            }
        else:
            cell["attachments"] = {"photo.png": {"image/png": picture}}
    document["metadata"] = {
        "kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"},
        "widgets": {"application/vnd.jupyter.widget-state+json": {"state": {"a": picture}}},
    }
    return json.dumps(document, indent=1).encode()
