"""Baked garments as they lie in folders.

inputs: what an outfit names; key: of inputs; record: digests of the files; store: where a bake lies; models: what an
exhibit is drawn with.
"""

from hall_app.content.bakes.inputs import outfit_files, outfit_problems
from hall_app.content.bakes.key import BAKE_VERSION, KEY_DIGITS, bake_key
from hall_app.content.bakes.models import ExhibitModels, models_of
from hall_app.content.bakes.record import FILES, Fault, publish, seal, seal_fault, seal_record, text_of
from hall_app.content.bakes.store import (
    bake_fault,
    bake_folder,
    bake_work,
    baked_here,
    data_bake,
    key_now,
    layer_files,
    read_record,
)

__all__ = [
    "BAKE_VERSION",
    "FILES",
    "KEY_DIGITS",
    "ExhibitModels",
    "Fault",
    "bake_fault",
    "bake_folder",
    "bake_key",
    "bake_work",
    "baked_here",
    "data_bake",
    "key_now",
    "layer_files",
    "models_of",
    "outfit_files",
    "outfit_problems",
    "publish",
    "read_record",
    "seal",
    "seal_fault",
    "seal_record",
    "text_of",
]
