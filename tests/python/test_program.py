"""The program's commands as functions."""

import json
import os
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

import kinecal
import scene

ROBOT = scene.SOURCE / "examples" / "mobile_manipulator" / "mobile_manipulator.urdf"


def grey(file: Path) -> np.ndarray:
    """A PNG of 8 bits without interlace, (height, width) uint8: what kinecal writes."""
    import struct
    import zlib

    data = file.read_bytes()
    width, height, depth, colour = struct.unpack(">IIBB", data[16:26])
    assert (depth, colour) == (8, 0), (depth, colour)
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at : at + 8])
        packed += data[at + 8 : at + 8 + size] if kind == b"IDAT" else b""
        at += size + 12
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, width + 1)
    image, above = np.zeros((height, width), np.uint8), np.zeros(width, np.uint8)
    for i, row in enumerate(rows):
        filtered = row[1:]
        if row[0] == 0:
            line = filtered.copy()
        elif row[0] == 1:
            line = np.cumsum(filtered, dtype=np.uint8)
        elif row[0] == 2:
            line = filtered + above
        else:
            raise AssertionError(f"filter {row[0]}")
        image[i] = above = line
    return image


class Commands(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.samples = scene.samples()
        cls.result = kinecal.calibrate(scene.robot(), cls.samples, scene.CONFIG)

    def test_a_result_holds_for_new_samples_of_the_same_robot(self) -> None:
        outcome = kinecal.verify(self.result, scene.samples(12, seed=8))
        self.assertTrue(outcome, outcome.text)
        self.assertIn("verdict: holds", str(outcome))
        self.assertEqual(outcome.code, 0)

    def test_a_result_does_not_hold_for_another_elbow(self) -> None:
        q, points = scene.measured(12, seed=8)
        q[:, 1] += 0.01
        moved = kinecal.Samples(
            q, ["shoulder", "elbow", "slide"], points={"arm": scene.POINTS, "tracker": points},
            frames={"arm": "hand", "tracker": "tracker_frame"},
        )
        outcome = kinecal.verify(self.result, moved)
        self.assertFalse(outcome)
        self.assertEqual(outcome.code, 2)
        self.assertIn("elbow", outcome.text)

    def test_others_say_how_well_it_fits(self) -> None:
        outcome = kinecal.evaluate(self.result, scene.samples(12, seed=8))
        self.assertIn("measured", outcome.text)
        self.assertTrue(outcome.report)
        same = kinecal.compare(self.result, self.result)
        self.assertTrue(same.report)

    def test_poses_are_chosen(self) -> None:
        chosen = kinecal.select_poses(
            scene.robot(), scene.CONFIG, self.samples, count=10, simulate=0, random=10
        )
        assert chosen.samples is not None
        self.assertEqual(len(chosen.samples), 10)
        known = {tuple(np.round(row, 9)) for row in self.samples.positions}
        for row in chosen.samples.positions:
            self.assertIn(tuple(np.round(row, 9)), known)

    def test_a_first_configuration(self) -> None:
        texts = kinecal.init(
            ROBOT, target="checkerboard", camera_type="camera2d", camera="head_camera_rgb_optical_frame"
        )
        self.assertEqual(sorted(texts), ["calibrate.yaml", "capture.yaml"])
        self.assertIn("error_blocks:", texts["calibrate.yaml"])

    def test_boards_are_found_in_arrays(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            folder = kinecal.simulate(ROBOT, name, target="apriltag", poses=4, seed=2)
            files = sorted((folder / "images").iterdir())
            common = {"camera": folder / "camera.yaml", "frame": "head_camera_rgb_optical_frame"}
            of_files = kinecal.detect(folder / "capture.yaml", folder / "images", folder / "poses.csv", **common)
            table = np.genfromtxt(folder / "poses.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
            joints = [joint for joint in table.dtype.names if joint != "image"]
            rows = {row["image"]: {joint: float(row[joint]) for joint in joints} for row in table}
            images = [grey(file) for file in files]
            of_arrays = kinecal.detect(
                folder / "capture.yaml", images, [rows[file.name] for file in files], **common
            )
        self.assertGreater(len(of_files), 0)
        np.testing.assert_array_equal(of_arrays.positions, of_files.positions)
        np.testing.assert_array_equal(of_arrays.features("camera")[0], of_files.features("camera")[0])

    def test_what_the_program_says_is_an_error(self) -> None:
        with self.assertRaisesRegex(kinecal.KinecalError, "nowhere.yaml"):
            kinecal.run("inspect", "nowhere.yaml")
        with self.assertRaisesRegex(kinecal.KinecalError, "--wobble"):
            kinecal.verify(self.result, self.samples, wobble=3)
        with self.assertRaisesRegex(kinecal.KinecalError, "images:1: float64"):
            kinecal.detect({"features": []}, [np.zeros((4, 4))])

    def test_a_robot_of_a_text_is_no_file_of_its_name(self) -> None:
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                Path("robot.urdf").write_text(ROBOT.read_text())
                chosen = kinecal.select_poses(
                    scene.robot(), json.dumps(scene.CONFIG.to_dict()), self.samples, count=5, simulate=0, random=5
                )
            finally:
                os.chdir(before)
        assert chosen.samples is not None
        self.assertEqual(sorted(chosen.samples.joints), ["elbow", "shoulder", "slide"])

    def test_without_the_program(self) -> None:
        with unittest.mock.patch.dict(os.environ, {"KINECAL": "/nowhere/kinecal"}):
            with self.assertRaisesRegex(kinecal.KinecalError, "/nowhere/kinecal: is no program"):
                kinecal.run("--version")


if __name__ == "__main__":
    unittest.main()
