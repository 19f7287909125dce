"""What is wrong with my arm: finds out which parameters differ from the URDF, and by how much.

    what_is_wrong.py robot.urdf samples.yaml

Samples are of any format that kinecal reads.  Without arguments an arm is simulated that a tracker watches: the zero
of its elbow is off by a degree, and its upper arm is 2 mm longer.
"""

import sys
from pathlib import Path

import numpy as np

import kinecal

EXAMPLE = Path(__file__).parents[1] / "mobile_manipulator" / "mobile_manipulator.urdf"
TIP = "gripper_link"


def simulated(robot: kinecal.Robot) -> kinecal.Samples:
    """Three reflectors on the gripper, measured in the base to 0.05 mm."""
    random = np.random.default_rng(2)
    reflectors = np.array([[0.05, 0.0, 0.0], [0.0, 0.05, 0.0], [0.0, 0.0, 0.05]])
    joints = robot.chain(TIP)
    wide = np.clip(robot.limits, -1.5, 1.5)[[robot.joint_names.index(joint) for joint in joints]]
    q = random.uniform(wide[:, 0], wide[:, 1], (50, len(joints)))
    zeros = np.where(np.array(joints) == "elbow_flex_joint", np.radians(1.0), 0.0)
    true = kinecal.Robot(robot.urdf.replace('xyz="0.133 0 0"', 'xyz="0.135 0 0"'))
    poses = true.forward_kinematics(q + zeros, TIP, joints=joints)
    seen = reflectors @ np.swapaxes(poses[:, :3, :3], 1, 2) + poses[:, np.newaxis, :3, 3]
    return kinecal.Samples(
        q,
        joints,
        points={"arm": reflectors, "tracker": seen + random.normal(0.0, 0.00005, seen.shape)},
        frames={"arm": "reflectors", "tracker": "tracker_frame"},
    )


def main(urdf: str = str(EXAMPLE), *files: str) -> int:
    robot = kinecal.Robot(urdf)
    samples = kinecal.Samples.read(*files) if files else simulated(robot)
    result = kinecal.identify(robot, samples)
    print(f"verdict: {result.verdict}")
    for reason in result.reasons:
        print(f"  because {reason}")
    print("next:", result.next)
    for parameter in sorted(result.parameters, key=lambda p: -abs(p.change / p.sigma)):
        certainty = abs(parameter.change / parameter.sigma)
        if certainty > 3.0:  # otherwise chance explains it
            print(f"{parameter.name:28} {parameter.change:+.6f} +- {parameter.sigma:.6f} {parameter.unit}")
    return 0 if result.is_usable else 2


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
