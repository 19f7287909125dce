"""Samples of arrays, records and files."""

import pickle
import tempfile
import unittest
from pathlib import Path

import numpy as np

import kinecal
import scene

JOINTS = ["shoulder", "elbow", "slide"]


class ArraysAndFiles(unittest.TestCase):
    def test_arrays_come_back(self) -> None:
        q, points = scene.measured()
        samples = scene.samples()
        self.assertEqual((len(samples), samples.joints, samples.sensors), (60, JOINTS, ["arm", "tracker"]))
        np.testing.assert_array_equal(samples.positions, q)
        seen, ids = samples.features("tracker")
        np.testing.assert_array_equal(seen, points)
        self.assertTrue((ids == -1).all())

    def test_files_have_the_same(self) -> None:
        samples = scene.samples()
        with tempfile.TemporaryDirectory() as folder:
            for name in ("samples.yaml", "samples.mcap", "samples.bag"):
                samples.save(Path(folder) / name)
                again = kinecal.Samples.read(Path(folder) / name)
                np.testing.assert_allclose(again.positions, samples.positions, atol=1e-15)
                np.testing.assert_allclose(again.features("arm")[0], samples.features("arm")[0])

    def test_some_of_them(self) -> None:
        samples = scene.samples()
        q = samples.positions
        mask = q[:, 0] > 0
        for chosen in (slice(3, 9), np.array([5, 2]), mask, -1):
            np.testing.assert_array_equal(samples[chosen].positions, np.atleast_2d(q[chosen]))
        self.assertEqual(len(samples[:2] + samples[10:13]), 5)
        self.assertEqual(len(sum([samples[:2], samples[5:6]])), 3)
        with self.assertRaises(TypeError):
            samples + 3
        self.assertEqual(len(pickle.loads(pickle.dumps(samples[:0]))), 0)
        self.assertEqual(len(list(samples[:3])), 3)
        with self.assertRaises(IndexError):
            samples[60]

    def test_they_can_be_pickled(self) -> None:
        samples = scene.samples()
        again = pickle.loads(pickle.dumps(samples))
        np.testing.assert_array_equal(again.features("tracker")[0], samples.features("tracker")[0])

    def test_what_was_not_seen(self) -> None:
        q, points = scene.measured(3)
        points[0, 1, 2] = np.nan
        points[2] = np.nan
        by_id = kinecal.Samples(
            q, JOINTS, points={"tracker": points}, frames={"tracker": "t"}, ids={"tracker": [7, 5, 3, 1]}
        )
        seen, ids = by_id.features("tracker")
        np.testing.assert_array_equal(ids, [[7, 3, 1, -1], [7, 5, 3, 1], [-1] * 4])
        self.assertTrue(np.isnan(seen[2]).all())
        by_place = kinecal.Samples(q, JOINTS, points={"tracker": points}, frames={"tracker": "t"})
        self.assertTrue(np.isnan(by_place.features("tracker")[0][0, 1]).all())

    def test_records_are_samples(self) -> None:
        q, points = scene.measured(5)
        records = [
            {
                "positions": dict(zip(JOINTS, row)),
                "points": {"tracker": seen, "arm": scene.POINTS},
                "conditions": {"temperature": 20.0 + i},
            }
            for i, (row, seen) in enumerate(zip(q, points))
        ]
        frames = {"tracker": "tracker_frame", "arm": "hand"}
        samples = kinecal.Samples.from_records(records, frames=frames)
        np.testing.assert_array_equal(samples.positions, q)
        np.testing.assert_array_equal(samples.features("tracker")[0], points)
        records[1]["positions"].pop("elbow")
        with self.assertRaisesRegex(kinecal.KinecalError, "records:2: has other joints"):
            kinecal.Samples.from_records(records, frames=frames)

    def test_what_is_wrong_is_said(self) -> None:
        q, points = scene.measured(4)
        nan = q.copy()
        nan[2, 1] = np.nan
        frame = {"frames": {"tracker": "t"}}
        poses = np.tile(np.eye(4), (4, 1, 1))
        poses[3, 0, 0] = 2.0
        wrong = [
            ("samples.positions:3: 'elbow' is nan; remove the row", (nan, JOINTS), {}),
            ("joints: 'a' is given twice", (q, ["a", "a", "b"]), {}),
            ("joints: 'abc' is no list of names", (q, "abc"), {}),
            ("points: a dict by names is expected, not ndarray", (q, JOINTS), {"points": points}),
            ("ids['tracker']: 1.5 is no whole number from 0 on", (q, JOINTS),
             {"points": {"tracker": points}, "ids": {"tracker": [1.5, 2, 3, 4]}, **frame}),
            ("joints: the names of the columns of positions are needed", (q,), {}),
            ("positions: has shape (4, 3); (n, 2) is expected", (q, ["a", "b"]), {}),
            ("points['tracker']: has shape (4, 4, 2); (4, k, 3) is expected", (q, JOINTS),
             {"points": {"tracker": points[:, :, :2]}, **frame}),
            ("points['tracker']: has shape (3, 4, 3); (4, k, 3) is expected", (q, JOINTS),
             {"points": {"tracker": points[:3]}, **frame}),
            ("frames: 'tracker' is missing: the link in which its points are given", (q, JOINTS),
             {"points": {"tracker": points}}),
            ("frames: 'trakcer' has neither points, pixels nor poses", (q, JOINTS),
             {"points": {"tracker": points}, "frames": {"trakcer": "t"}}),
            ("poses['tracker']:4: its upper left is no rotation", (q, JOINTS), {"poses": {"tracker": poses}, **frame}),
            ("ids['tracker']: 2 for 4 features", (q, JOINTS),
             {"points": {"tracker": points}, "ids": {"tracker": [1, 2]}, **frame}),
            ("ids['tracker']: the same id twice", (q, JOINTS),
             {"points": {"tracker": points}, "ids": {"tracker": [1, 2, 2, 3]}, **frame}),
            ("conditions['run']: has shape (3,); (4) is expected", (q, JOINTS), {"conditions": {"run": [1, 2, 3]}}),
            ("cameras['tracker']: 'K' is missing", (q, JOINTS),
             {"points": {"tracker": points}, "cameras": {"tracker": {"width": 1}}, **frame}),
        ]
        for message, arguments, options in wrong:
            with self.assertRaises(kinecal.KinecalError) as raised:
                kinecal.Samples(*arguments, **options)
            self.assertEqual(str(raised.exception), message)

    def test_what_is_masked_was_not_seen(self) -> None:
        q, points = scene.measured(3)
        masked = np.ma.masked_less(points, points[0, 0, 0] + 1e-12) if points[0, 0, 0] < 0 else np.ma.masked_greater(points, 0)
        samples = kinecal.Samples(q, JOINTS, points={"tracker": masked}, frames={"tracker": "t"})
        np.testing.assert_array_equal(np.isnan(samples.features("tracker")[0]).any(axis=2), masked.mask.any(axis=2))

    def test_cameras_are_checked(self) -> None:
        k = [[600.0, 0, 320], [0, 600, 240], [0, 0, 1]]
        good = {"K": k, "width": 640, "height": 480}
        pixels = {"camera": np.full((2, 3, 2), 100.0)}
        wrong = {
            "'d' is no key of a camera": {**good, "d": [0.1]},
            "is expected": {**good, "K": [[600.0, 1, 320], [0, 600, 240], [0, 0, 1]]},
            "640.5 is no whole number from 1 on": {**good, "width": 640.5},
            "'foo' is no distortion_model": {**good, "distortion_model": "foo"},
            "is outside of 240 x 640 pixels": {**good, "width": 240, "height": 640},
        }
        for message, camera in wrong.items():
            with self.assertRaises(kinecal.KinecalError) as raised:
                kinecal.Samples(
                    np.zeros((2, 1)), ["a"], pixels=pixels, frames={"camera": "c"}, cameras={"camera": camera}
                )
            self.assertIn(message, str(raised.exception))

    def test_a_file_that_is_wrong_is_named_with_its_line(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "samples.yaml"
            file.write_text("joint_states: {name: [a], position: [x]}\nobservations: []\n")
            with self.assertRaises(kinecal.KinecalError) as raised:
                kinecal.Samples.read(file)
        self.assertEqual((raised.exception.file, raised.exception.line), (str(file), 1))


if __name__ == "__main__":
    unittest.main()
