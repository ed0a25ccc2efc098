"""Points that follow a person: motion files, feature points, rigid alignment, limb refinement, filters."""

from sim_core.track.alignment import Alignment, align
from sim_core.track.calibration import Calibration, calibrate
from sim_core.track.chart import save_chart
from sim_core.track.disturbance import Disturbance
from sim_core.track.feature_points import Binding, FeaturePoints, feature_points
from sim_core.track.files import ENDINGS, MAPPINGS, load_mapping, read_bvh, read_recording, write_tracked
from sim_core.track.recording import Recording
from sim_core.track.settings import FILTERS, TrackSettings
from sim_core.track.skeletons import KINECT, TrackedSkeleton, figure_skeleton
from sim_core.track.summary import summary
from sim_core.track.tracker import Tracked, TrackedFrame, Tracker, track

__all__ = [
    "Alignment",
    "Binding",
    "Calibration",
    "Disturbance",
    "ENDINGS",
    "FILTERS",
    "FeaturePoints",
    "KINECT",
    "MAPPINGS",
    "Recording",
    "TrackSettings",
    "Tracked",
    "TrackedFrame",
    "TrackedSkeleton",
    "Tracker",
    "align",
    "calibrate",
    "feature_points",
    "figure_skeleton",
    "load_mapping",
    "read_bvh",
    "read_recording",
    "save_chart",
    "summary",
    "track",
    "write_tracked",
]
