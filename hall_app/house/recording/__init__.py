"""Film and sound that were brought: decoded to see whether they are, kept in what browsers play, nothing told beside.

Little is imported here: every process that looks at a file begins with it.
formats: what is read and written; reading: decoded, judged, copied; encoding: made anew where browsers play it not.
"""

from hall_app.house.recording.reading import LONGEST, Kept, Refused, keep

__all__ = ["LONGEST", "Kept", "Refused", "keep"]
