"""Pictures brought to the office: drawn anew as they look, whatever their samples are."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from hall_app.house.drafts import take_in

RAMP = np.tile(np.arange(256, dtype=np.int32), (16, 1))
GREYS = {
    "sixteen bits as PNG": ("PNG", (RAMP * 257).astype(np.uint16)),
    "sixteen bits as TIFF": ("TIFF", (RAMP * 257).astype(np.uint16)),
    "thirty-two bits that hold sixteen": ("TIFF", RAMP * 257),
    "thirty-two bits that hold eight": ("TIFF", RAMP),
    "eight bits": ("TIFF", RAMP.astype(np.uint8)),
}


@pytest.mark.parametrize("case", GREYS)
def test_grey_of_any_depth_stays_as_grey_as_it_is(case):
    form, samples = GREYS[case]
    brought = io.BytesIO()
    Image.fromarray(samples).save(brought, form)
    one = take_in("scan", brought, len(brought.getvalue()), "picture")
    assert one.told == "256 × 16"
    shown = np.asarray(Image.open(io.BytesIO(one.data)).convert("L"), dtype=np.int32)
    assert np.abs(shown - RAMP).max() <= (0 if form == "PNG" else 6), "JPEG is a little off"
