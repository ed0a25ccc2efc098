"""Run in an environment with dtx_to_wif and pyweaving: which of the named drafts each reads, and seconds of reading.

python peer_drafts.py FILE ...   prints {"dtx_to_wif": {FILE: seconds or an error}, "pyweaving": ...}
"""

import json
import sys
import time

found: dict[str, dict[str, object]] = {"dtx_to_wif": {}, "pyweaving": {}}


def by_dtx_to_wif(path: str) -> None:
    from dtx_to_wif import read_dtx, read_wif

    with open(path, encoding="utf-8") as stream:
        (read_dtx if path.endswith(".dtx") else read_wif)(stream)


def by_pyweaving(path: str) -> None:
    from pyweaving.wif import WIFReader

    draft = WIFReader(path).read()
    list(draft.compute_floats())


for path in sys.argv[1:]:
    for name, read in (("dtx_to_wif", by_dtx_to_wif), ("pyweaving", by_pyweaving)):
        begin = time.perf_counter()
        try:
            read(path)
            found[name][path] = time.perf_counter() - begin
        except Exception as error:
            found[name][path] = f"{type(error).__name__}: {error}"[:120]
print(json.dumps(found))
