"""Photographs of a board in, the camera's place on the robot out.

    photographs_to_hand_eye.py robot.urdf camera_frame photographs/ calibrated/

The folder has images/, poses.csv (a column for each joint, and "image"), capture.yaml (what the board is; kinecal.init
writes one) and camera.yaml (camera_info).  Without arguments photographs of a simulated robot are rendered.
"""

import sys
import tempfile
from pathlib import Path

import kinecal

EXAMPLE = Path(__file__).parents[1] / "mobile_manipulator" / "mobile_manipulator.urdf"
CAMERA = "head_camera_rgb_optical_frame"


def calibrated(robot: kinecal.Robot, camera: str, folder: Path) -> kinecal.Result:
    """Finds the board, frees what its corners can show, and calibrates."""
    samples = kinecal.detect(
        folder / "capture.yaml",
        folder / "images",
        folder / "poses.csv",
        camera=folder / "camera.yaml",
        frame=camera,
        urdf=robot.file,
    )
    print(samples)
    config = kinecal.init(robot, samples, camera=camera)
    return kinecal.calibrate(robot, samples, config["calibrate.yaml"])


def main(urdf: str = str(EXAMPLE), camera: str = CAMERA, photographs: str = "", output: str = "") -> int:
    robot = kinecal.Robot(urdf)
    with tempfile.TemporaryDirectory() as folder:
        if not photographs:
            photographs = str(kinecal.simulate(robot, Path(folder, "simulated"), poses=20, seed=1))
        result = calibrated(robot, camera, Path(photographs))
    before = robot.forward_kinematics({}, camera)[0]
    after = result.robot.forward_kinematics({}, camera)[0]
    shift = 1e3 * (after - before)[:3, 3]
    print(result)
    print(f"{camera} moves by {shift[0]:.2f} {shift[1]:.2f} {shift[2]:.2f} mm in {robot.root}")
    if output:
        print("written:", result.save(output))
    return 0 if result.is_usable else 2


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
