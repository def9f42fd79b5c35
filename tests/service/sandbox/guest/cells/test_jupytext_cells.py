import pytest

from service.sandbox.guest.cells.jupytext_cells import MOST_PIECES, pieces


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
