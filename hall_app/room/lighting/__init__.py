"""The room as its light is computed: charts of its patches, spots in the ceiling, exhibits that cast shadows."""

from hall_app.room.lighting.charts import charts_of, surfaces
from hall_app.room.lighting.lamps import spots_of
from hall_app.room.lighting.occluders import exhibit_solids

__all__ = ["charts_of", "exhibit_solids", "spots_of", "surfaces"]
