"""The light map's charts: packing, side by side; texels, the places in them; filters, what is done within each."""

from hall_app.light.atlas.packing import Atlas, atlas_of, pack

__all__ = ["Atlas", "atlas_of", "pack"]
