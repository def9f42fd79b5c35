import os

import pytest

from service.cli.output_file import write
from tests.support.limits import largest_file


def test_what_cannot_be_written_as_a_whole_is_not_written(tmp_path):
    (tmp_path / "x").write_text("as it was")
    with largest_file(3000), pytest.raises(OSError, match="File too large"):
        write(tmp_path / "x", "y" * 5000)
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("x", "as it was")]


def test_what_is_no_file_is_written_to_and_not_replaced(tmp_path):
    """Such as /dev/stdout, which a container's root could replace for good."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write(pipe, "told")
    assert os.read(reader, 10) == b"told" and pipe.is_fifo()
    os.close(reader)
