"""Forward kinematics and Jacobians of arrays against a chain written out in NumPy."""

import pickle
import unittest

import numpy as np

import kinecal

ARM = """<robot name="arm">
  <link name="base"/><link name="upper"/><link name="fore"/><link name="hand"/><link name="finger"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>
    <origin xyz="0 0 0.3" rpy="0 0 0.2"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
  <joint name="elbow" type="continuous"><parent link="upper"/><child link="fore"/>
    <origin xyz="0.4 0 0" rpy="1.1 0 0"/><axis xyz="0 1 0"/></joint>
  <joint name="slide" type="prismatic"><parent link="fore"/><child link="hand"/>
    <origin xyz="0.1 0 0"/><axis xyz="1 0 0"/><limit lower="0" upper="0.5" effort="1" velocity="1"/></joint>
  <joint name="follower" type="prismatic"><parent link="hand"/><child link="finger"/>
    <axis xyz="0 0 1"/><mimic joint="slide" multiplier="0.5"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>
</robot>"""


def turn(axis: int, angle: float) -> np.ndarray:
    """(4, 4) rotation about x, y or z."""
    i, k = [(1, 2), (2, 0), (0, 1)][axis]
    pose = np.eye(4)
    pose[i, i] = pose[k, k] = np.cos(angle)
    pose[i, k], pose[k, i] = -np.sin(angle), np.sin(angle)
    return pose


def shift(x: float, y: float, z: float) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def hand(shoulder: float, elbow: float, slide: float) -> np.ndarray:
    """base_T_hand of the arm."""
    return (
        shift(0, 0, 0.3) @ turn(2, 0.2) @ turn(2, shoulder) @ shift(0.4, 0, 0) @ turn(0, 1.1)
        @ turn(1, elbow) @ shift(0.1 + slide, 0, 0)
    )


class Kinematics(unittest.TestCase):
    def setUp(self) -> None:
        self.robot = kinecal.Robot(ARM)
        self.q = np.random.default_rng(1).uniform(-1.5, 1.5, (13, 3))

    def test_a_robot_is_what_its_urdf_says(self) -> None:
        self.assertEqual(self.robot.joint_names, ["shoulder", "elbow", "slide"])
        self.assertEqual(self.robot.root, "base")
        self.assertEqual(self.robot.chain("hand", "upper"), ["elbow", "slide"])
        np.testing.assert_array_equal(self.robot.limits, [[-2, 2], [-np.inf, np.inf], [0, 0.5]])
        self.assertEqual(self.robot.joints[3].mimic, "slide")
        self.assertIn("3 joints", repr(self.robot))
        self.assertIn("<table>", self.robot._repr_html_())

    def test_poses_are_those_of_the_chain(self) -> None:
        expected = [hand(*q) for q in self.q]
        np.testing.assert_allclose(self.robot.forward_kinematics(self.q, "hand"), expected, atol=1e-14)
        np.testing.assert_allclose(self.robot.forward_kinematics(self.q[0], "hand"), expected[0], atol=1e-14)
        inverse = self.robot.forward_kinematics(self.q, "base", base="hand")
        np.testing.assert_allclose(inverse, np.linalg.inv(expected), atol=1e-14)

    def test_positions_by_name_are_columns(self) -> None:
        by_name = {"slide": self.q[:, 2], "elbow": 0.3}
        expected = [hand(0.0, 0.3, q[2]) for q in self.q]
        np.testing.assert_allclose(self.robot.forward_kinematics(by_name, "hand"), expected, atol=1e-14)
        swapped = self.robot.forward_kinematics(self.q[:, ::-1], "hand", joints=["slide", "elbow", "shoulder"])
        np.testing.assert_array_equal(swapped, self.robot.forward_kinematics(self.q, "hand"))

    def test_jacobians_are_derivatives(self) -> None:
        step = 1e-6
        for frame, base in (("hand", None), ("finger", None), ("base", "finger")):
            jacobians = self.robot.jacobian(self.q, frame, base=base)
            self.assertEqual(jacobians.shape, (13, 6, 3))
            poses = self.robot.forward_kinematics(self.q, frame, base=base)
            for joint in range(3):
                change = step * np.eye(3)[joint]
                ahead = self.robot.forward_kinematics(self.q + change, frame, base=base)
                behind = self.robot.forward_kinematics(self.q - change, frame, base=base)
                slope = (ahead - behind) / (2 * step)
                spin = slope[:, :3, :3] @ np.swapaxes(poses[:, :3, :3], 1, 2)
                angular = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1)
                np.testing.assert_allclose(jacobians[:, :3, joint], slope[:, :3, 3], atol=1e-9)
                np.testing.assert_allclose(jacobians[:, 3:, joint], angular, atol=1e-9)

    def test_arrays_of_any_layout_are_read(self) -> None:
        expected = self.robot.forward_kinematics(self.q, "hand")
        frozen = np.asfortranarray(self.q)
        frozen.flags.writeable = False
        wide = np.zeros((26, 6))
        wide[::2, ::2] = self.q
        for q in (frozen, wide[::2, ::2], self.q.tolist()):
            np.testing.assert_array_equal(self.robot.forward_kinematics(q, "hand"), expected)
        single = self.robot.forward_kinematics(self.q.astype(np.float32), "hand")
        np.testing.assert_allclose(single, expected, atol=1e-6)
        self.assertEqual(self.robot.forward_kinematics(np.zeros((0, 3)), "hand").shape, (0, 4, 4))

    def test_what_is_wrong_is_said(self) -> None:
        wrong = {
            "no link 'hnad' in robot 'arm'; did you mean 'hand'?": (self.q, "hnad", {}),
            "q: has shape (13, 2); (n, 3) or (3,) is expected: shoulder, elbow, slide": (self.q[:, :2], "hand", {}),
            "q: <U1 are no real numbers": (["a", "b", "c"], "hand", {}),
            "q: complex128 are no real numbers": (self.q.astype(complex), "hand", {}),
            "'elbo' is no joint of arm; did you mean 'elbow'?": ({"elbo": 1.0}, "hand", {}),
            "'follower' follows 'slide': give that one": ({"follower": 1.0}, "hand", {}),
            "joints: 'elbow' is given twice": (self.q[:, :2], "hand", {"joints": ["elbow", "elbow"]}),
        }
        for message, (q, frame, options) in wrong.items():
            with self.assertRaises(kinecal.KinecalError) as raised:
                self.robot.forward_kinematics(q, frame, **options)
            self.assertEqual(str(raised.exception), message)

    def test_a_urdf_that_is_none_is_named_with_its_line(self) -> None:
        with self.assertRaises(kinecal.KinecalError) as raised:
            kinecal.Robot("<robot name='r'>\n<link name='a'/>\n<link>\n</robot>")
        self.assertEqual((raised.exception.file, raised.exception.line), ("robot.urdf", 4))
        with self.assertRaisesRegex(kinecal.KinecalError, "nowhere.urdf: "):
            kinecal.Robot("nowhere.urdf")

    def test_a_robot_can_be_pickled(self) -> None:
        again = pickle.loads(pickle.dumps(self.robot))
        np.testing.assert_array_equal(
            again.forward_kinematics(self.q, "hand"), self.robot.forward_kinematics(self.q, "hand")
        )


if __name__ == "__main__":
    unittest.main()
