"""A table of a laser tracker in, the corrected URDF out.

    table_to_urdf.py robot.urdf table.csv tip_link calibrated/

The table has a row for each pose: a column for each joint, named as in the URDF (radians, metres), and x, y, z of the
reflector on the tip (metres, in the tracker's frame).  Without arguments a table is simulated.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import kinecal

EXAMPLE = Path(__file__).parents[1] / "mobile_manipulator" / "mobile_manipulator.urdf"
REFLECTOR = np.array([0.03, 0.02, 0.05, 1.0])  # metres, in the tip


def simulated_table(robot: kinecal.Robot, tip: str, file: Path) -> None:
    """What a tracker measures of a robot whose zeros are off, with a noise of 0.05 mm."""
    random = np.random.default_rng(1)
    joints = robot.chain(tip)
    limits = np.clip(robot.limits[[robot.joint_names.index(joint) for joint in joints]], -1.5, 1.5)
    q = random.uniform(limits[:, 0], limits[:, 1], (60, len(joints)))
    zeros = random.normal(0.0, 0.02, len(joints))
    points = robot.forward_kinematics(q + zeros, tip, joints=joints) @ REFLECTOR
    points = points[:, :3] + [2.0, 0.5, -0.3] + random.normal(0.0, 0.00005, (60, 3))
    np.savetxt(file, np.hstack([q, points]), delimiter=",", comments="", header=",".join([*joints, "x", "y", "z"]))


def calibrated(robot: kinecal.Robot, file: Path, tip: str) -> kinecal.Result:
    """Frees what the table can show: zeros of joints, the tracker's place, the reflector's."""
    columns = file.read_text().splitlines()[0].split(",")
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    samples = kinecal.Samples(
        table[:, :-3],
        columns[:-3],
        points={"arm": np.zeros((1, 3)), "tracker": table[:, np.newaxis, -3:]},
        frames={"arm": "smr", "tracker": "tracker_frame"},
    )
    config = kinecal.init(robot, samples, target="tracker", arm=tip, target_frame="smr")
    return kinecal.calibrate(robot, samples, config["calibrate.yaml"])


def main(urdf: str = str(EXAMPLE), table: str = "", tip: str = "gripper_link", output: str = "") -> int:
    robot = kinecal.Robot(urdf)
    with tempfile.TemporaryDirectory() as folder:
        if not table:
            simulated_table(robot, tip, Path(folder, "table.csv"))
        result = calibrated(robot, Path(table or f"{folder}/table.csv"), tip)
    print(result)
    if output:
        print("written:", result.save(output))
    return 0 if result.is_usable else 2


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
