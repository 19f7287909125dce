"""Calibrations of arrays: errors that were put in are found, and files are those of the program."""

import json
import pickle
import subprocess
import sys
import tempfile
import threading
import unittest
import unittest.mock
from pathlib import Path

import numpy as np

import kinecal
import scene


class Calibration(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.samples = scene.samples()
        cls.result = kinecal.calibrate(scene.robot(), cls.samples, scene.CONFIG)

    def test_injected_errors_are_found_within_their_deviations(self) -> None:
        result = self.result
        self.assertEqual(result.verdict, "good", str(result))
        self.assertTrue(result.is_usable)
        truth = {"elbow": scene.ELBOW, **dict(zip(("tracker_frame_x", "tracker_frame_y", "tracker_frame_z"), scene.TRACKER))}
        for name, value in truth.items():
            found = result[name]
            self.assertLess(found.sigma, 2e-5)
            self.assertLess(abs(found.after - value), 4 * found.sigma, name)
        with self.assertRaisesRegex(kinecal.KinecalError, "'shoulder' was not calibrated"):
            result["shoulder"]

    def test_figures_go_together(self) -> None:
        result = self.result
        names = [parameter.name for parameter in result.parameters]
        self.assertEqual(len(names), 7)
        np.testing.assert_allclose(
            np.sqrt(np.diag(result.covariance)), [p.sigma for p in result.parameters], rtol=1e-6
        )
        block = result.residuals["measured"]
        self.assertEqual((block.residual.shape, block.unit), ((240, 3), "m"))
        np.testing.assert_allclose(np.linalg.norm(block.residual, axis=1), block.after, atol=1e-12)
        rms = np.sqrt(np.mean(block.after**2))
        self.assertLess(abs(rms / (np.sqrt(3) * scene.NOISE) - 1), 0.1)  # of 720 numbers
        self.assertGreater(block.before.mean(), 1e-3)
        self.assertIn("elbow", str(result))
        self.assertEqual(result.report["verdict"], "good")

    def test_the_corrected_robot_is_where_it_was_measured(self) -> None:
        q, points = scene.measured(20, seed=9)
        poses = self.result.robot.forward_kinematics(q, "hand")
        found = np.einsum("nij,kj->nki", poses[:, :3, :3], scene.POINTS) + poses[:, None, :3, 3]
        self.assertLess(np.abs(found - (points + scene.TRACKER)).max(), 10 * scene.NOISE)

    def test_files_are_those_of_the_program(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "robot.urdf").write_text(scene.robot().urdf)
            (folder / "calibrate.yaml").write_text(json.dumps(scene.CONFIG.to_dict()))
            self.samples.save(folder / "samples.yaml")
            words = ["--urdf", folder / "robot.urdf", "--config", folder / "calibrate.yaml"]
            words += ["--samples", folder / "samples.yaml", "--output", folder / "program"]
            kinecal.run("calibrate", *words)
            again = kinecal.calibrate(folder / "robot.urdf", folder / "samples.yaml", folder / "calibrate.yaml")
            saved = again.save(folder / "python")
            for file in ("calibrated.urdf", "calibration.yaml", "residuals.csv", "original.urdf", "config.yaml"):
                self.assertEqual((saved / file).read_text(), (folder / "program" / file).read_text(), file)
            self.assertEqual(again.urdf, (folder / "program" / "calibrated.urdf").read_text())
            with self.assertRaisesRegex(kinecal.KinecalError, "calibrated.urdf: exists; save"):
                again.save(folder / "python")
            again.save(folder / "python", overwrite=True)
            self.assertTrue(kinecal.verify(saved, scene.samples(10, seed=5)))
            self.assertTrue(kinecal.verify(self.result, scene.samples(10, seed=5)))

    def test_a_dict_and_yaml_are_the_same_configuration(self) -> None:
        text = "base_link: base\n" + "\n".join(
            f"{key}: {json.dumps(value)}" for key, value in scene.CONFIG.to_dict().items() if key != "base_link"
        )
        for config in (scene.CONFIG.to_dict(), text):
            result = kinecal.calibrate(scene.robot(), self.samples, config)
            self.assertEqual(result.urdf, self.result.urdf)

    def test_many_samples_are_calibrated_part_by_part(self) -> None:
        samples = scene.samples(400)
        at_once = kinecal.calibrate(scene.robot(), samples, scene.CONFIG)
        with unittest.mock.patch.multiple(kinecal.calibration, _MANY=100, _ROWS=70):
            samples = scene.samples(400)
            in_parts = kinecal.calibrate(scene.robot(), samples, scene.CONFIG, draw=90)
            self.assertIsNone(samples._list, "the arrays were copied")
        self.assertEqual(in_parts.verdict, "good", str(in_parts))
        self.assertEqual(in_parts.report["samples"], 400)
        for one, other in zip(at_once.parameters, in_parts.parameters):
            self.assertLess(abs(one.after - other.after), 0.05 * one.sigma, one.name)
            self.assertLess(abs(one.sigma / other.sigma - 1), 0.2, one.name)
        misspelt = kinecal.Samples(
            np.zeros((120, 1)), ["elbw"], points={"arm": scene.POINTS, "tracker": np.ones((120, 4, 3))},
            frames={"arm": "hand", "tracker": "tracker_frame"},
        )
        with unittest.mock.patch.multiple(kinecal.calibration, _MANY=100, _ROWS=70):
            with self.assertRaisesRegex(kinecal.KinecalError, "joint 'shoulder' is not in the sample"):
                kinecal.calibrate(scene.robot(), misspelt, scene.CONFIG)

    def test_what_the_samples_support_is_found(self) -> None:
        config = {**scene.CONFIG.to_dict(), "free_params": []}
        result = kinecal.identify(scene.robot(), self.samples, config)
        self.assertLess(abs(result["elbow"].after - scene.ELBOW), 1e-4)
        self.assertIn("elbow", result.config)

    def test_a_result_can_be_pickled(self) -> None:
        again = pickle.loads(pickle.dumps(self.result))
        self.assertEqual(again.urdf, self.result.urdf)
        self.assertEqual(str(again), str(self.result))
        self.assertEqual(again.parameters, self.result.parameters)
        self.assertEqual(again.report_html(), self.result.report_html())
        np.testing.assert_array_equal(again.residuals["measured"].after, self.result.residuals["measured"].after)

    def test_a_notebook_shows_verdict_table_and_page(self) -> None:
        text = self.result._repr_html_()
        self.assertIn("<b>good</b>", text)
        self.assertIn("<td>elbow</td>", text)
        self.assertIn("<iframe srcdoc=", text)
        self.assertTrue(self.result.report_html().rstrip().endswith("</html>"))

    def test_a_result_outlives_what_it_was_made_of(self) -> None:
        samples, robot = scene.samples(30), scene.robot()
        result = kinecal.calibrate(robot, samples, scene.CONFIG)
        del samples, robot
        self.assertIn("elbow", result.urdf)

    def test_progress_is_told_and_may_end_it(self) -> None:
        steps = []
        kinecal.calibrate(scene.robot(), self.samples, scene.CONFIG, progress=lambda *of: steps.append(of))
        self.assertGreater(len(steps), 1)
        self.assertEqual(len(steps[0]), 3)

        def stop(*_: object) -> None:
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            kinecal.calibrate(scene.robot(), self.samples, scene.CONFIG, progress=stop)

    def test_zeros_go_where_they_are_asked_to(self) -> None:
        origins = kinecal.calibrate(scene.robot(), self.samples, scene.CONFIG, offsets="origin")
        self.assertEqual(origins.urdf, self.result.robot.urdf)
        self.assertIn("rising", self.result.urdf)
        with self.assertRaisesRegex(kinecal.KinecalError, "offsets: 'somewhere' is none of"):
            kinecal.calibrate(scene.robot(), self.samples, scene.CONFIG, offsets="somewhere")

    def test_several_at_once(self) -> None:
        found: list[str] = []
        threads = [
            threading.Thread(
                target=lambda: found.append(kinecal.calibrate(scene.robot(), self.samples, scene.CONFIG).urdf)
            )
            for _ in range(4)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(found, [self.result.urdf] * 4)

    def test_an_interruption_ends_a_solve(self) -> None:
        program = (
            "import signal, kinecal, scene\n"
            "signal.signal(signal.SIGINT, signal.default_int_handler)  # where it is ignored, as behind &\n"
            "def interrupt(*_):\n"
            "    signal.raise_signal(signal.SIGINT)\n"
            "try:\n"
            "    kinecal.calibrate(scene.robot(), scene.samples(), scene.CONFIG, progress=interrupt)\n"
            "except KeyboardInterrupt:\n"
            "    print('stopped')\n"
        )
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=Path(__file__).parent)
        self.assertEqual((done.stdout, done.returncode), ("stopped\n", 0), done.stderr)

    def test_what_is_wrong_is_said(self) -> None:
        config = scene.CONFIG.to_dict()
        wrong = {
            "'elbo' is neither": {**config, "free_params": ["elbo"]},
            "no model is given": {**config, "models": []},
            "nowhere.yaml: cannot be read": "nowhere.yaml",
        }
        for message, given in wrong.items():
            with self.assertRaises(kinecal.KinecalError) as raised:
                kinecal.calibrate(scene.robot(), self.samples, given)
            self.assertIn(message, str(raised.exception))
        q, points = scene.measured(20)
        misspelt = kinecal.Samples(
            q, ["shoulder", "elbow", "slid"], points={"arm": scene.POINTS, "tracker": points},
            frames={"arm": "hand", "tracker": "tracker_frame"},
        )
        with self.assertRaisesRegex(kinecal.KinecalError, "samples:1: .*slide"):
            kinecal.calibrate(scene.robot(), misspelt, scene.CONFIG)
        with self.assertRaisesRegex(kinecal.KinecalError, "axes: 'w' is none of x, y, z"):
            kinecal.free("a", axes="x w")
        for arguments, message in (
            ((None, self.samples), "a robot is a file"),
            ((scene.robot(), [1]), "samples: Samples or a file are expected"),
            ((scene.robot(), self.samples[:0]), "samples: there are none"),
            ((scene.robot(), self.samples, 3), "neither a file"),
            ((scene.robot(), self.samples, ""), "neither a file"),
        ):
            with self.assertRaisesRegex(kinecal.KinecalError, message):
                kinecal.calibrate(*arguments)
        with self.assertRaisesRegex(kinecal.KinecalError, "hold: a list is expected"):
            kinecal.calibrate(scene.robot(), self.samples, scene.CONFIG, hold="elbow")

    def test_degrees_are_refused(self) -> None:
        q, points = scene.measured()
        degrees = kinecal.Samples(
            np.rad2deg(q), ["shoulder", "elbow", "slide"], points={"arm": scene.POINTS, "tracker": points},
            frames={"arm": "hand", "tracker": "tracker_frame"},
        )
        with self.assertRaisesRegex(kinecal.KinecalError, "they look like degrees") as raised:
            kinecal.calibrate(scene.robot(), degrees, scene.CONFIG)
        self.assertEqual((raised.exception.file, raised.exception.name), ("samples", "shoulder"))


class RealRobot(unittest.TestCase):
    def test_a_ur5_measured_by_a_tracker(self) -> None:
        folder = scene.data("ur5_tracker")
        read = kinecal.Samples.read(folder / "grid.yaml")
        points, _ = read.features("tracker")
        samples = kinecal.Samples(
            read.positions, read.joints, points={"tracker": points, "arm": np.zeros((1, 3))},
            frames={"tracker": "tracker_frame", "arm": "smr"},
        )
        result = kinecal.calibrate(folder / "ur5.urdf", samples, folder / "full.yaml")
        after = result.residuals["measured"].after
        self.assertAlmostEqual(1e3 * np.sqrt(np.mean(after**2)), 0.111660, 6)
        with tempfile.TemporaryDirectory() as name:
            words = ["--urdf", folder / "ur5.urdf", "--config", folder / "full.yaml"]
            kinecal.run("calibrate", *words, "--samples", folder / "grid.yaml", "--output", name)
            self.assertEqual(result.urdf, (Path(name) / "calibrated.urdf").read_text())


if __name__ == "__main__":
    unittest.main()
