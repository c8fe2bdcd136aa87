"""Scans and images learnt by a straightforward script: one message, one patch at a time.

rosbags deserializes every message, OpenCV decodes at full or half size, numpy describes
the patches of one image at a time, Algorithm 1 of the paper takes in scans and patches, and
scikit-learn clusters the cluster-points. The peer of ``mpap learn`` for a log with a camera.
"""

import sys
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import numpy as np
from rosbags.highlevel import AnyReader

from benchmarks.speed.images import by_numpy
from benchmarks.speed.straightforward import Features, MetaPoints, cluster

PATCH_THETA = 0.21


class LearntBoth(NamedTuple):
    """How much was learnt."""

    n_scans: int
    n_images: int
    n_scan_clusters: int
    n_patch_clusters: int


def main(path: Path, decode: int = cv2.IMREAD_COLOR) -> LearntBoth:
    """Learn from one log; ``decode`` says how OpenCV decodes."""
    features, of_scans, of_patches = Features(), MetaPoints(), MetaPoints(PATCH_THETA)
    n_scans = n_images = n_presses = 0
    is_pressed = False
    with AnyReader([path]) as reader:
        names = {"/scan", "/bumper", "/camera/image_raw/compressed"}
        chosen = [one for one in reader.connections if one.topic in names]
        for connection, stamp_ns, raw in reader.messages(connections=chosen):
            message: Any = reader.deserialize(raw, connection.msgtype)
            if connection.topic == "/scan":
                of_scans.add_data_point(features(stamp_ns, message).astype(np.float64))
                n_scans += 1
            elif connection.topic == "/bumper":
                n_presses += bool(message.data) and not is_pressed
                is_pressed = bool(message.data)
            else:
                image = cv2.imdecode(message.data, decode)
                for patch in by_numpy(np.asarray(image, np.uint8)).astype(np.float64):
                    of_patches.add_data_point(patch)
                n_images += 1
    found = [
        cluster(np.array([model.exemplars[row] for row in model.rows[True]]))
        for model in (of_scans, of_patches)
    ]
    return LearntBoth(n_scans, n_images, *found)


if __name__ == "__main__":
    print(main(Path(sys.argv[1])))
