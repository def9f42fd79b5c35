import pytest

from service.sandbox.guest.pieces import MOST_PIECES, needed_sources, pieces


def test_a_percent_file_is_its_cells_and_lines_keep_their_numbers():
    found = pieces("x = 1\n# %% [markdown]\n# words\n# %%\ny = 2\n# %%\nz = (\n")
    assert found == [
        "x = 1\n",
        "\n# %% [markdown]\n# words\n",
        "\n\n\n# %%\ny = 2\n",
        "\n\n\n\n\n# %%\nz = (\n",
    ]
    with pytest.raises(SyntaxError) as caught:
        compile(found[-1], "cell 1", "exec")
    assert caught.value.lineno == 7


@pytest.mark.parametrize(
    "source", ["x = 1", "text = '''\n# %%\nno cell'''\ny = 1", "x = 1\n# %%\n" * MOST_PIECES]
)
def test_other_files_stay_whole(source):
    assert pieces(source) == [source]


IMPORT, HELPER, F, PLOT = (
    "import numpy as np",
    "def g(x):\n    return np.sin(x)",
    "def f(x):\n    return a * g(x)",
    "y = f(1.0)",
)


@pytest.mark.parametrize(
    ("sources", "names", "needed"),
    [
        ([IMPORT, HELPER, "a = 2", F, PLOT], ["f"], [0, 1, 2, 3]),
        ([IMPORT, HELPER, "a = 2", F, PLOT], ["g"], [0, 1]),
        ([IMPORT, HELPER, "a = 2", F, PLOT], ["y"], [0, 1, 2, 3, 4]),
        ([F, "a = 2", "a = 3", "print(a)"], ["f"], [0, 1, 2]),
        (["a = 2", "a += 1", "for a in (1, 2):\n    pass", F], ["f"], [0, 1, 2, 3]),
        (["%magic f", F], ["f"], [0, 1]),
        (["from numpy import *", F], ["f"], [0, 1]),
        (["class A(B):\n    x = c", "B = object", "c = 1", "d = 1", "f = A().x"], ["f"], [0, 1, 2, 4]),
        (["f.b = 1", F], ["f"], [1]),  # a changed object: the host then asks again with all cells
        ([PLOT], ["missing"], []),
    ],
)
def test_the_sources_that_bind_what_the_names_need(sources, names, needed):
    assert needed_sources(sources, names) == {sources[k] for k in needed}
