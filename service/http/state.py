"""What the application holds while it runs, as typed dependencies of routes.

``app.state.held`` has one object of each class; the lifespan stores them. A route or dependency with a
parameter of the type ``Held[Listener]`` receives the application's listener.
"""

from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_origin

from fastapi import Depends, Request

from service.settings import Settings
from service.store.database import Database

T = TypeVar("T")

if TYPE_CHECKING:
    Held = Annotated[T, "of the application"]
else:

    class Held:
        """``Held[T]`` is the application's object of the class ``T``."""

        def __class_getitem__(cls, kind: type) -> Any:
            async def find(request: Request) -> Any:
                return request.app.state.held[get_origin(kind) or kind]

            return Annotated[kind, Depends(find)]


Db = Held[Database]
Config = Held[Settings]
