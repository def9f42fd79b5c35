"""A process that is lost is replaced, and its caller learns of it."""

import asyncio
import os
import time

import pytest

from service.api.separate_process import ProcessLost, SeparateProcess


def test_a_process_that_dies_or_does_not_return_is_replaced():
    async def main():
        process, hasty = SeparateProcess(60.0), SeparateProcess(0.1)
        first = await process.call(os.getpid)
        assert first == await process.call(os.getpid) != os.getpid()
        with pytest.raises(ZeroDivisionError):
            await process.call(divmod, 1, 0)
        with pytest.raises(ProcessLost):
            await process.call(os._exit, 1)
        assert await process.call(os.getpid) not in (first, os.getpid())
        with pytest.raises(ProcessLost):
            await hasty.call(time.sleep, 600.0)
        process.stop()

    asyncio.run(main())
