"""Routes of the collection in the formats museums use; the documents themselves are made in hall_app.web.collection."""

from __future__ import annotations

import json
from collections.abc import Callable
from datetime import UTC, datetime
from typing import Any
from urllib.parse import parse_qsl

from fastapi import FastAPI, HTTPException, Request
from fastapi.responses import Response

from hall_app.house.house import House
from hall_app.web.answers.packed import REVALIDATED, Packed
from hall_app.web.answers.work import SLOW, Answers
from hall_app.web.collection import dublin_core, iiif, iiif_scene, lido, schema_org
from hall_app.web.collection.glb import licensed_glb
from hall_app.web.collection.oai_pmh import harvested
from hall_app.web.collection.record import GLB, Collection, Item, collection_of
from hall_app.web.collection.table.sheet import table
from sim_core.gltf import GlbError

__all__ = ["OPEN", "add_collection", "collection_now"]

OPEN = {
    "Access-Control-Allow-Origin": "*"
}  # viewers and harvesters of other houses read it from their own pages
_MOST_FORM = 16 << 10  # [bytes] of a request to /oai
_XML, _CSV = "application/xml; charset=utf-8", "text/csv; charset=utf-8"

Whole = Callable[[Collection], bytes]
Each = Callable[[Collection, Item], bytes]


def _json(make: Callable[..., dict[str, Any]]) -> Callable[..., bytes]:
    return lambda *told: json.dumps(make(*told), ensure_ascii=False, indent=1).encode()


_WHOLE: dict[str, tuple[str, Whole]] = {
    "/iiif/3/collection": (iiif.MEDIA_TYPE, _json(iiif.collection_document)),
    "/iiif/4/collection": (iiif_scene.MEDIA_TYPE, _json(iiif_scene.scene_collection)),
    "/collection/lido.xml": (_XML, lido.lido_wrap),
    "/collection/schema.jsonld": (schema_org.MEDIA_TYPE, _json(schema_org.whole_graph)),
}
_EACH: dict[str, tuple[str, Each]] = {
    "/iiif/3/{exhibit}/manifest": (iiif.MEDIA_TYPE, _json(iiif.manifest)),
    "/iiif/4/{exhibit}/manifest": (iiif_scene.MEDIA_TYPE, _json(iiif_scene.scene_manifest)),
    "/collection/{exhibit}/lido.xml": (_XML, lido.lido_document),
    "/collection/{exhibit}/dc.xml": (_XML, dublin_core.dublin_core_document),
    "/collection/{exhibit}/schema.jsonld": (schema_org.MEDIA_TYPE, _json(schema_org.artwork)),
}


def collection_now(house: House, address: str) -> Callable[[], Collection]:
    """What reads the collection that stands in the hall now, in whatever thread. address: as `collection_of` has it."""
    content = house.content
    models = {exhibit.id: house.models(exhibit.id) for exhibit in content.exhibits}
    return lambda: collection_of(content, models.get, address)


def add_collection(app: FastAPI, house: House) -> None:
    """Every document of the hall and of its exhibits, the table, the models with their licence, and OAI-PMH."""
    kept = Answers()  # of their own: a visitor may have asked under another name of this machine

    async def now(request: Request) -> tuple[Collection, tuple[object, ...]]:
        address = str(request.base_url).rstrip("/")
        state = (*house.state, address)
        return await kept.of(state, "collection", collection_now(house, address)), state

    def add(path: str, media_type: str, make: Callable[..., bytes]) -> None:
        async def answer(request: Request) -> Response:
            collection, state = await now(request)
            told = (collection, *(_item(collection, name) for name in request.path_params.values()))
            asked = (path, *request.path_params.values())
            packed = await kept.of(state, asked, lambda: Packed(make(*told), media_type))
            return _opened(await packed.answer(request))

        app.add_api_route(path, answer, include_in_schema=False)

    for path, (media_type, make) in (_WHOLE | _EACH).items():
        add(path, media_type, make)
    add("/collection/table.csv", _CSV, lambda collection: table(house.content.exhibits))
    _add_models(app, house, now)
    _add_harvest(app, now)


def _opened(answer: Response) -> Response:
    answer.headers.update(OPEN)
    return answer


def _item(collection: Collection, name: str) -> Item:
    item = collection.item(name)
    if item is None:
        raise HTTPException(404, f"no exhibit {name!r} in the hall")
    return item


def _add_models(app: FastAPI, house: House, now: Callable[..., Any]) -> None:
    @app.get("/collection/{exhibit}/model.glb", include_in_schema=False)
    async def model(request: Request, exhibit: str) -> Response:
        collection, state = await now(request)
        item = _item(collection, exhibit)

        def made() -> bytes:
            return licensed_glb(item.model.path.read_bytes(), collection, item)

        try:
            data = await SLOW.of(("licensed", state, exhibit), made)
        except (OSError, GlbError) as error:  # it is being replaced just now
            raise HTTPException(503, "the model is not there at the moment: ask again") from error
        name = f'attachment; filename="{item.id}.glb"'
        told = {"Content-Disposition": name, "Cache-Control": REVALIDATED, **OPEN}
        return Response(data, media_type=GLB, headers=told)


def _add_harvest(app: FastAPI, now: Callable[..., Any]) -> None:
    async def answer(request: Request, form: str) -> Response:
        collection, _ = await now(request)
        try:
            arguments = parse_qsl(form, keep_blank_values=True, max_num_fields=20)
        except ValueError:
            arguments = []  # as many arguments no verb takes

        def made() -> bytes:
            return harvested(collection, arguments, datetime.now(UTC))

        data = await SLOW.of(("harvest", object()), made)
        told = {"Cache-Control": "no-store", **OPEN}
        return Response(data, media_type="text/xml; charset=utf-8", headers=told)

    @app.get("/oai", include_in_schema=False)
    async def by_address(request: Request) -> Response:
        return await answer(request, request.url.query)

    @app.post("/oai", include_in_schema=False)
    async def by_form(request: Request) -> Response:
        form = b""
        async for part in request.stream():
            form += part
            if len(form) > _MOST_FORM:
                raise HTTPException(413, "no request of OAI-PMH is that long")
        return await answer(request, form.decode("utf-8", "replace"))
