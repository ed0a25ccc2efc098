"""Baked garments as they lie in folders.

inputs: what an outfit names; key: of inputs; steps: of the meshes; record: digests of the files; store:
where a bake lies; models: what an exhibit is drawn with; accessories: which layer one comes to see.
"""

from hall_app.content.bakes.accessories import cloth_area, garment_at
from hall_app.content.bakes.inputs import outfit_files, outfit_problems, scan_files
from hall_app.content.bakes.key import BAKE_VERSION, KEY_DIGITS, bake_key
from hall_app.content.bakes.models import ExhibitModels, models_of
from hall_app.content.bakes.record import FILES, Fault, publish, seal, seal_fault, seal_record, text_of
from hall_app.content.bakes.steps import Step, Study, budget, chosen_steps, read_study
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
    "Step",
    "Study",
    "bake_fault",
    "bake_folder",
    "bake_key",
    "bake_work",
    "baked_here",
    "budget",
    "chosen_steps",
    "cloth_area",
    "data_bake",
    "garment_at",
    "key_now",
    "layer_files",
    "models_of",
    "outfit_files",
    "outfit_problems",
    "publish",
    "read_record",
    "read_study",
    "scan_files",
    "seal",
    "seal_fault",
    "seal_record",
    "text_of",
]
