"""WIF 1.0 and 1.1: read tolerantly, written strictly.

`model` holds the value and turns drafts into it and back. `reader` takes bytes to `sections`, and these to `threads`
and `colours`; `writer` goes the other way. `cloth` dresses a draft of another program with the yarns it does not
name.
"""

from sim_core.weave.files.wif.model import PRIVATE, Wif, wif_of
from sim_core.weave.files.wif.reader import parse_wif, read_wif
from sim_core.weave.files.wif.sections import decoded
from sim_core.weave.files.wif.writer import wif_text, write_wif

__all__ = ["PRIVATE", "Wif", "decoded", "parse_wif", "read_wif", "wif_of", "wif_text", "write_wif"]
