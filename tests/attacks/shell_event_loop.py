"""Waits in the event loop for what never comes, and replaces the loop."""

# ends: pass slow
import asyncio

get_ipython().loop_runner = lambda coroutine: coroutine.send(None)
attempt("connection", lambda: asyncio.run(asyncio.open_connection("127.0.0.1", TCP_PORT)))
attempt("subprocess", lambda: asyncio.run(asyncio.create_subprocess_shell("id")))
attempt("nothing", lambda: asyncio.run(asyncio.Event().wait()))
asyncio.run(asyncio.sleep(1000))
