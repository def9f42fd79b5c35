"""Ask the web application in this process, without a server: real routes on a real database."""

import asyncio

import httpx2

from service.app import create_app
from service.settings import Settings


def visit(url, *paths):
    """Return the answers to GET of each of the ``paths``, from an application on the database at ``url``."""

    async def visits():
        app = create_app(Settings(database_url=url))
        transport = httpx2.ASGITransport(app)
        async with (
            app.router.lifespan_context(app),
            httpx2.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000") as client,
        ):
            return [await client.get(path) for path in paths]

    return asyncio.run(visits())
