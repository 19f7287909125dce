"""A fleet over months: which robots still hold their calibration, which have to be calibrated again, and what moved.

    fleet_over_months.py fleet/

Each robot has fleet/NAME/result, which Result.save() wrote, and samples of a few poses a month, fleet/NAME/*.yaml.
Without arguments a fleet is simulated; an elbow of it slips.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import kinecal

EXAMPLE = Path(__file__).parents[1] / "mobile_manipulator" / "mobile_manipulator.urdf"
TIP = "gripper_link"


def tracked(robot: kinecal.Robot, zeros: NDArray[np.float64], poses: int, seed: int) -> kinecal.Samples:
    """A reflector on the gripper, measured in the base to 0.05 mm."""
    random = np.random.default_rng(seed)
    joints = robot.chain(TIP)
    low, high = np.clip(robot.limits, -1.5, 1.5)[[robot.joint_names.index(joint) for joint in joints]].T
    q = random.uniform(low, high, (poses, len(joints)))
    seen = (robot.forward_kinematics(q + zeros, TIP, joints=joints) @ [0.03, 0.02, 0.05, 1.0])[:, np.newaxis, :3]
    points = {"arm": np.zeros((1, 3)), "tracker": seen + random.normal(0.0, 0.00005, seen.shape)}
    return kinecal.Samples(q, joints, points=points, frames={"arm": "smr", "tracker": "tracker_frame"})


def simulate(fleet: Path) -> None:
    """Two robots over four months; the elbow of the second slips by 0.2 degrees in March."""
    robot = kinecal.Robot(EXAMPLE)
    for number, name in enumerate(("robot_a", "robot_b")):
        zeros = np.random.default_rng(number).normal(0.0, 0.01, len(robot.chain(TIP)))
        first = tracked(robot, zeros, 50, 10 * number)
        config = kinecal.init(robot, first, target="tracker", arm=TIP, target_frame="smr")
        kinecal.calibrate(robot, first, config["calibrate.yaml"]).save(fleet / name / "result")
        for month in range(1, 5):
            zeros[4] += np.radians(0.2) * (name == "robot_b" and month == 3)  # elbow_flex_joint
            tracked(robot, zeros, 10, 10 * number + month).save(fleet / name / f"2026-{month:02}.yaml")


def main(fleet: str = "") -> int:
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        if not fleet:
            simulate(Path(folder))
        for result in sorted(Path(fleet or folder).glob("*/result")):
            for month in sorted(result.parent.glob("*.yaml")):
                outcome = kinecal.verify(result, month)
                failed += not outcome
                print(result.parent.name, month.stem, "holds" if outcome else f"does not hold\n{outcome}")
    return 2 if failed and fleet else 0  # the simulated elbow is meant to slip


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
