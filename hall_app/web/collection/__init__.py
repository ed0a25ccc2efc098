"""The collection in the formats museums use: pure functions from its records to documents.

record: what every format tells of hall and exhibits; markup: XML as values; licences: their addresses. iiif,
iiif_scene, lido, dublin_core, schema_org, glb: one format each. oai_pmh: the protocol that hands them on. table: the
catalogue as CSV, out and in, and `hall collection`. routes: their addresses.
"""

from hall_app.web.collection.dublin_core import dublin_core_document
from hall_app.web.collection.glb import licensed_glb
from hall_app.web.collection.iiif import collection_document, manifest
from hall_app.web.collection.iiif_scene import scene_collection, scene_manifest
from hall_app.web.collection.licences import licence_address
from hall_app.web.collection.lido import lido_document, lido_wrap
from hall_app.web.collection.markup import Node, document, node
from hall_app.web.collection.oai_pmh import harvested
from hall_app.web.collection.record import Collection, Item, Medium, Model, Source, collection_of
from hall_app.web.collection.schema_org import artwork, in_page, whole_graph

__all__ = [
    "Collection",
    "Item",
    "Medium",
    "Model",
    "Node",
    "Source",
    "artwork",
    "collection_document",
    "collection_of",
    "document",
    "dublin_core_document",
    "harvested",
    "in_page",
    "licence_address",
    "licensed_glb",
    "lido_document",
    "lido_wrap",
    "manifest",
    "node",
    "scene_collection",
    "scene_manifest",
    "whole_graph",
]
