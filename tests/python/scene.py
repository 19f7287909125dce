"""A simulated arm with a wrong elbow that a tracker measures, and where the shared data are."""

import os
import unittest
from pathlib import Path

import numpy as np

import kinecal
from test_kinematics import ARM, hand

SOURCE = Path(__file__).resolve().parents[2]
DATA = Path(os.environ.get("KINECAL_DATA", SOURCE.parent / "shared" / "data"))

ELBOW = 0.02  #: radians: what the elbow lacks
TRACKER = (0.5, -1.0, 0.2)  #: metres: where the tracker stands
NOISE = 1e-5  #: metres
CONFIG = kinecal.Config(
    base_link="base",
    models=[kinecal.Chain3d("arm", "hand"), kinecal.Chain3d("tracker", "base")],
    error_blocks=[kinecal.Block("measured", "chain3d_to_chain3d", model_a="arm", model_b="tracker")],
    free=[*kinecal.free("elbow"), *kinecal.free("tracker_frame", axes="x y z roll pitch yaw")],
)
#: Four points of the hand, metres.
POINTS = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])


def measured(count: int = 60, seed: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3), and points (n, 4, 3) in the tracker."""
    random = np.random.default_rng(seed)
    q = random.uniform((-1.5, -2.5, 0.0), (1.5, 2.5, 0.5), (count, 3))
    poses = np.array([hand(*(row + (0, ELBOW, 0))) for row in q])
    points = np.einsum("nij,kj->nki", poses[:, :3, :3], POINTS) + poses[:, None, :3, 3]
    return q, points - TRACKER + NOISE * random.standard_normal(points.shape)


def samples(count: int = 60, seed: int = 2) -> kinecal.Samples:
    q, points = measured(count, seed)
    return kinecal.Samples(
        q,
        ["shoulder", "elbow", "slide"],
        points={"arm": POINTS, "tracker": points},
        frames={"arm": "hand", "tracker": "tracker_frame"},
    )


def robot() -> kinecal.Robot:
    return kinecal.Robot(ARM)


def data(name: str) -> Path:
    """A folder of the shared data; skips the test where it is absent."""
    folder = DATA / name
    if not folder.is_dir():
        if os.environ.get("KINECAL_REQUIRE_DATA") == "1":
            raise AssertionError(f"{folder} is missing")
        raise unittest.SkipTest(f"{folder} is missing")
    return folder
