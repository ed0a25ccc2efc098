"""What is read, what browsers play, and in what it is written: containers by the ending of a file."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["DECODERS", "PICTURES", "PLAIN", "READ", "SOUNDS", "WRITTEN"]

# By ending: the demuxer, which is never guessed, since some read other files and addresses than the one they are given.
READ: Mapping[str, str] = {
    ".mp4": "mov",
    ".m4a": "mov",
    ".webm": "matroska",
    ".ogg": "ogg",
    ".mp3": "mp3",
    ".wav": "wav",
}
_DECODED = "h264 hevc av1 libdav1d vp8 vp9 mpeg4 mpeg1video mpeg2video h263 mjpeg prores theora"
_HEARD = "aac mp3float mp3 opus libopus vorbis flac alac ac3 eac3 amrnb amrwb mp2float adpcm_ms adpcm_ima_wav"
_SAMPLES = "pcm_s16le pcm_s16be pcm_s24le pcm_s24be pcm_s32le pcm_f32le pcm_u8 pcm_alaw pcm_mulaw"
DECODERS = frozenset(f"{_DECODED} {_HEARD} {_SAMPLES}".split())

# By ending: the muxer, and what browsers play in it.
WRITTEN: Mapping[str, str] = {
    ".mp4": "mp4",
    ".m4a": "mp4",
    ".webm": "webm",
    ".ogg": "ogg",
    ".mp3": "mp3",
    ".wav": "wav",
}
PICTURES: Mapping[str, frozenset[str]] = {
    ".mp4": frozenset({"h264", "vp9", "av1"}),
    ".webm": frozenset({"vp8", "vp9", "av1"}),
}
SOUNDS: Mapping[str, frozenset[str]] = {
    ".mp4": frozenset({"aac", "mp3", "opus", "flac"}),
    ".webm": frozenset({"opus", "vorbis"}),
    ".m4a": frozenset({"aac", "flac"}),
    ".ogg": frozenset({"opus", "vorbis", "flac"}),
    ".mp3": frozenset({"mp3"}),
    ".wav": frozenset({"pcm_s16le", "pcm_u8", "pcm_s24le", "pcm_f32le"}),
}
# Of H.264 browsers know eight bits and colours at half the size, whatever a camera's studio would have.
PLAIN = frozenset({"yuv420p", "yuvj420p"})
