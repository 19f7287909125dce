"""Fixed cameras of a cell and a board that the arm holds: where each camera stands, in the robot's base.

    cameras_of_a_cell.py robot.urdf cell.npz tip_link calibrated/

Arrays of the file: positions (n, joints), joints (names), board (k, 3) corners on the board, metres; for each camera
left_pixels (n, k, 2), NaN: not seen, left_K (3, 3) and left_size (2).  Without arguments a cell is simulated.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np

import kinecal

EXAMPLE = Path(__file__).parents[1] / "mobile_manipulator" / "mobile_manipulator.urdf"


def simulated(robot: kinecal.Robot, tip: str) -> dict[str, Any]:
    """Three cameras that look at a point before a robot whose zeros are off, and see corners to 0.1 px."""
    random = np.random.default_rng(3)
    q = random.uniform(-0.6, 0.6, (40, 8)) * ([0.2] + 7 * [1.0]) + [0.15, 0.0, 0.3, 0.0, -0.9, 0.0, 0.6, 0.0]
    cell: dict[str, Any] = {"positions": q, "joints": robot.chain(tip)}
    cell["board"] = board = np.array([(0.04 * i, 0.04 * j, 0.0) for j in range(4) for i in range(5)])
    poses = robot.forward_kinematics(q + random.normal(0.0, 0.01, 8), tip, joints=cell["joints"])
    corners = board @ np.swapaxes(poses[:, :3, :3], 1, 2) + poses[:, np.newaxis, :3, 3]
    k = np.array([[900.0, 0.0, 640.0], [0.0, 900.0, 480.0], [0.0, 0.0, 1.0]])
    for name, stand in {"left": (0.8, 1.2, 1.0), "right": (0.8, -1.2, 1.0), "top": (0.9, 0.1, 2.3)}.items():
        x = np.cross(z := np.array([0.8, 0.0, 0.8]) - stand, [0.0, 0.02, 1.0])  # z: where it looks
        axes = np.array([axis / np.linalg.norm(axis) for axis in (x, np.cross(z, x), z)])
        seen = (corners - stand) @ axes.T @ k.T
        pixels = seen[..., :2] / seen[..., 2:] + random.normal(0.0, 0.1, (40, 20, 2))
        pixels[((pixels < 0) | (pixels > [1280, 960])).any(axis=-1) | (seen[..., 2] < 0.1)] = np.nan
        cell |= {f"{name}_pixels": pixels, f"{name}_K": k, f"{name}_size": (1280, 960)}
    return cell


def main(urdf: str = str(EXAMPLE), file: str = "", tip: str = "gripper_link", output: str = "") -> int:
    robot = kinecal.Robot(urdf)
    cell = dict(np.load(file)) if file else simulated(robot, tip)
    names = [name[:-2] for name in cell if name.endswith("_K")]
    sizes = {name: dict(zip(("width", "height"), cell[f"{name}_size"])) for name in names}
    cameras = {name: {"K": cell[f"{name}_K"], **sizes[name]} for name in names}
    link = '<link name="{0}"/><joint name="{0}_joint" type="fixed"><parent link="{1}"/><child link="{0}"/></joint>'
    links = "".join(link.format(name, robot.root) for name in names)
    pixels = {name: cell[f"{name}_pixels"] for name in names}
    seen: dict[str, Any] = {"points": {tip: cell["board"]}, "pixels": pixels, "cameras": cameras}
    seen["frames"] = {tip: "board", **dict(zip(names, names))}
    samples = kinecal.Samples(cell["positions"], list(cell["joints"]), **seen)
    robot = kinecal.Robot(robot.urdf.replace("</robot>", links + "</robot>"))
    config = kinecal.init(robot, samples)["calibrate.yaml"]
    print(result := kinecal.calibrate(robot, samples, config))
    if output:
        result.save(output)
    return 0 if result.is_usable else 2


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
