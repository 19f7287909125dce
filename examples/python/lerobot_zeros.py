"""A LeRobot data set in; zeros of servos with +-, a patched calibration file and a grade of each episode out.

    lerobot_zeros.py dataset/ calibration.json robot.urdf degrees|normalized output/ [feetech|dynamixel [link of the board]]

dataset/ is that of LeRobot (v2 or v3: meta/info.json, data/*/*.parquet), or its tables as CSV in the same folders.
A board or known points on the arm must be seen by a camera that stands still:

    dataset/board.csv       id, x, y, z: places on the board that the gripper holds, metres, in a frame of its own
    dataset/features.csv    episode_index, frame_index, id, u, v: where the camera sees them, pixels
    dataset/camera.yaml     camera_info

or, instead of the tables, dataset/capture.yaml (what the board is) and images as LeRobot lays them out,
dataset/images/KEY/episode-000000/frame-000000.png.  Joints of the URDF have the names of the motors.  The unit is
that of observation.state: "degrees" if the robot was recorded with use_degrees, else "normalized" (-100 to 100).
Output: the calibration file for LeRobot, calibrated.urdf with the camera's place, the camera file, the report.
Without arguments a data set is simulated, in which the camera is bumped during one episode.
"""

import csv
import json
import re
import sys
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinecal

EXAMPLE = Path(__file__).parents[1] / "mobile_manipulator" / "mobile_manipulator.urdf"
TICKS = 4096  # of a turn
CAMERA = "camera"  # sensor and link
MOST_IMAGES = 100  # in which the board is looked for
Array = NDArray[np.float64]
Frame = tuple[int, int]  # episode, number in it


def rows_of(file: Path) -> Iterator[dict[str, Any]]:
    """Rows of a table: parquet if pyarrow is there, or CSV."""
    if file.suffix == ".csv":
        with file.open(newline="", encoding="utf-8-sig") as text:
            yield from csv.DictReader(text)
        return
    try:
        from pyarrow import parquet  # type: ignore[import]
    except ImportError:
        raise kinecal.KinecalError(
            f"{file}: parquet is read with pyarrow: pip install pyarrow, or export the table as CSV beside it"
        ) from None
    columns = ["observation.state", "episode_index", "frame_index"]
    yield from parquet.read_table(file, columns=columns).to_pylist()


def motors_of(file: Path) -> dict[str, Any]:
    """LeRobot's calibration: {"elbow_flex": {"id": 3, "drive_mode": 0, "homing_offset": -1103, "range_min": ...}}."""
    try:
        calibration: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        for motor in calibration.values():
            if motor["range_max"] <= motor["range_min"] or motor.get("drive_mode", 0) not in (0, 1):
                raise ValueError("range_max is not above range_min, or drive_mode is neither 0 nor 1")
            int(motor["homing_offset"])
    except (OSError, AttributeError, KeyError, TypeError, ValueError) as error:
        raise kinecal.KinecalError(f"{file}: is not a calibration of LeRobot: {error!r}") from None
    return calibration


def motor_names(dataset: Path) -> list[str]:
    """Names of observation.state without ".pos" and "main_", in its order."""
    info = dataset / "meta" / "info.json"
    try:
        names = json.loads(info.read_text(encoding="utf-8"))["features"]["observation.state"]["names"]
    except (OSError, KeyError, TypeError, json.JSONDecodeError) as error:
        raise kinecal.KinecalError(f"{info}: features of observation.state cannot be read: {error!r}") from None
    if isinstance(names, dict):  # v2.0: {"motors": [...]}
        names = next(iter(names.values()))
    return [str(name).removesuffix(".pos").removeprefix("main_") for name in names]


def states_of(dataset: Path, motors: list[str]) -> dict[Frame, list[float]]:
    """observation.state of each frame, in its unit."""
    files = sorted(dataset.glob("data/*/*.parquet")) or sorted(dataset.glob("data/*/*.csv"))
    if not files:
        raise kinecal.KinecalError(f"{dataset}/data: has neither */*.parquet nor */*.csv")
    states: dict[Frame, list[float]] = {}
    for file in files:
        for number, row in enumerate(rows_of(file), 2):
            try:
                state = row.get("observation.state")
                if state is None:  # a column for each motor
                    state = [row.get(f"{motor}.pos", row.get(motor)) for motor in motors]
                elif isinstance(state, str):  # "[1.5, -20.1]" or "[1.5 -20.1]"
                    state = re.split(r"[,\s]+", state.strip("[] \n"))
                values = [float(value) for value in state]
                frame = int(row["episode_index"]), int(row["frame_index"])
            except (KeyError, TypeError, ValueError) as error:
                raise kinecal.KinecalError(f"{file}:{number}: cannot be read: {error!r}") from None
            if len(values) != len(motors) or not np.isfinite(values).all():
                raise kinecal.KinecalError(f"{file}:{number}: observation.state is not {len(motors)} finite numbers")
            states[frame] = values
    return states


def radians(state: Array, motors: list[str], calibration: dict[str, Any], unit: str) -> Array:
    """Joint positions of states (n, motors), as LeRobot's _normalize() made them of ticks.

    degrees      state = (ticks - middle) 360 / 4095, whatever drive_mode is
    normalized   state = 200 (ticks - range_min) / (range_max - range_min) - 100, the sign turned with drive_mode 1
    """
    if unit == "degrees":
        return np.asarray(np.radians(state) * (TICKS - 1) / TICKS)
    ranges = np.array([calibration[motor]["range_max"] - calibration[motor]["range_min"] for motor in motors])
    return np.asarray(state / 200.0 * ranges * 2.0 * np.pi / TICKS)


def still(states: dict[Frame, list[float]], frame: Frame) -> bool:
    """Whether the arm stands: camera and joints are not read at the same time."""
    around = [states[(frame[0], n)] for n in range(frame[1] - 1, frame[1] + 2) if (frame[0], n) in states]
    return float(np.ptp(around, axis=0).max()) < 0.3


def seen_features(dataset: Path, frames: Iterable[Frame]) -> tuple[Array, dict[Frame, Array]]:
    """Places on the board (k, 3), and pixels (k, 2) of each frame."""
    if (dataset / "features.csv").exists():
        board = {int(row["id"]): [float(row[x]) for x in "xyz"] for row in rows_of(dataset / "board.csv")}
        places = {number: i for i, number in enumerate(board)}
        pixels: dict[Frame, Array] = {}
        for row in rows_of(dataset / "features.csv"):
            frame = int(row["episode_index"]), int(row["frame_index"])
            seen = pixels.setdefault(frame, np.full((len(board), 2), np.nan))
            if int(row["id"]) in places:
                seen[places[int(row["id"])]] = float(row["u"]), float(row["v"])
        return np.array(list(board.values())), pixels
    images = {
        (int(match[1]), int(match[2])): file
        for file in sorted(dataset.glob("images/*/episode-*/frame-*.*"))
        if (match := re.search(r"episode-(\d+)/frame-(\d+)\.", file.as_posix()))
    }
    chosen = [frame for frame in frames if frame in images]
    if not chosen:
        raise kinecal.KinecalError(
            f"{dataset}: has neither features.csv nor images of frames in which the arm stands; extract those of a "
            "video: ffmpeg -i episode_000000.mp4 -start_number 0 images/KEY/episode-000000/frame-%06d.png"
        )
    chosen = chosen[:: -(-len(chosen) // MOST_IMAGES)]
    with tempfile.TemporaryDirectory() as folder:
        for frame in chosen:
            name = f"{frame[0]:06d}_{frame[1]:06d}{images[frame].suffix}"
            Path(folder, name).symlink_to(images[frame].resolve())
        poses = Path(folder, "poses.csv")
        lines = [f"{e:06d}_{f:06d}{images[e, f].suffix},{i}" for i, (e, f) in enumerate(chosen)]
        poses.write_text("\n".join(["image,number", *lines]) + "\n")
        found = kinecal.detect(dataset / "capture.yaml", folder, poses, camera=dataset / "camera.yaml", frame=CAMERA)
    arm = next(sensor for sensor in found.sensors if sensor != CAMERA)
    corners, seen = found.features(arm)[0], found.features(CAMERA)[0][..., :2]
    numbers = found.positions[:, found.joints.index("number")].astype(int)
    return corners[0], {chosen[number]: seen[i] for i, number in enumerate(numbers)}


def samples_by_episode(
    dataset: Path, calibration: dict[str, Any], joints: list[str], unit: str
) -> dict[int, kinecal.Samples]:
    """Samples of the frames in which the arm stands and the board is seen."""
    motors = motor_names(dataset)
    missing = [motor for motor in motors if motor in joints and motor not in calibration]
    missing += [] if set(motors) & set(joints) else motors
    if missing:
        raise kinecal.KinecalError(
            f"'{missing[0]}' is no motor of the calibration and no joint of the URDF: motors of the data set "
            f"{', '.join(motors)}; of the calibration {', '.join(calibration)}; joints {', '.join(joints)}"
        )
    states = states_of(dataset, motors)
    standing = [frame for frame in states if still(states, frame)]
    board, pixels = seen_features(dataset, standing)
    used = [frame for frame in standing if frame in pixels]
    kept = [motor for motor in motors if motor in joints]
    columns = [motors.index(motor) for motor in kept]
    others = [joint for joint in joints if joint not in kept]  # that no motor moves: at zero
    samples = {}
    for episode in sorted({episode for episode, _ in used}):
        frames = [frame for frame in used if frame[0] == episode]
        state = np.array([states[frame] for frame in frames])[:, columns]
        samples[episode] = kinecal.Samples(
            np.hstack([radians(state, kept, calibration, unit), np.zeros((len(frames), len(others)))]),
            [*kept, *others],
            points={"arm": board},
            pixels={CAMERA: np.array([pixels[frame] for frame in frames])},
            frames={"arm": "board", CAMERA: CAMERA},
            cameras={CAMERA: dataset / "camera.yaml"},
        )
    if not samples:
        raise kinecal.KinecalError(f"{dataset}: in no frame the arm stands and the board is seen")
    return samples


def with_camera(robot: kinecal.Robot) -> kinecal.Robot:
    """The robot with a link for the camera, on its root, where it has none."""
    if CAMERA in robot.links:
        return robot
    joint = f'<joint name="{CAMERA}_joint" type="fixed"><parent link="{robot.root}"/><child link="{CAMERA}"/></joint>'
    return kinecal.Robot(robot.urdf.replace("</robot>", f'<link name="{CAMERA}"/>{joint}</robot>'))


def graded(episodes: dict[int, kinecal.Samples], urdf: Path, config: Path, folder: Path) -> list[int]:
    """Episodes that agree with the others."""
    for episode, samples in episodes.items():
        samples.save(folder / f"episode_{episode:06d}.yaml")
    outcome = kinecal.grade(sorted(folder.glob("episode_*.yaml")), urdf=urdf, config=config)
    print(str(outcome).replace(f"{folder}/", ""))
    rows = outcome.report["episodes"]
    return [int(Path(row["name"]).stem.split("_")[-1]) for row in rows if row["consistent"]]


def patched(file: Path, unit: str, make: str, *arguments: str | Path) -> tuple[kinecal.Outcome, str]:
    """Calibrates with a copy of the calibration file that gets the zeros.

    States in degrees, and those of Dynamixel, count as their servo does, whatever drive_mode is.
    """
    calibration = motors_of(file)
    as_servo = unit == "degrees" or make == "dynamixel"
    motors = {name: {**motor, **({"drive_mode": 0} if as_servo else {})} for name, motor in calibration.items()}
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder, file.name)
        copy.write_text(json.dumps(motors), encoding="utf-8")
        outcome = kinecal.run("calibrate", *arguments, "--homing", copy, "--servos", make)
        for name, motor in json.loads(copy.read_text(encoding="utf-8")).items():
            calibration[name]["homing_offset"] = motor["homing_offset"]
    return outcome, json.dumps(calibration, indent=4) + "\n"


def simulated(folder: Path) -> list[str]:
    """Ten episodes of an arm with a board in its gripper, in whose fifth the camera is bumped by 5 mm."""
    random = np.random.default_rng(4)
    robot = kinecal.Robot(EXAMPLE)
    joints = robot.chain("gripper_link")[1:]  # without the torso
    zeros = np.round(random.normal(0.0, 0.02, len(joints)) * TICKS / 2 / np.pi) * 2 * np.pi / TICKS
    calibration = {
        joint: {"id": i + 1, "drive_mode": i % 2, "homing_offset": 40 * i, "range_min": 1000, "range_max": 3000 + i}
        for i, joint in enumerate(joints)
    }
    ranges = np.array([motor["range_max"] - motor["range_min"] for motor in calibration.values()])
    board = np.array([(0.03 * i, 0.03 * j, 0.0) for j in range(4) for i in range(5)])
    data = folder / "data" / "chunk-000"
    for path in (data, folder / "meta"):
        path.mkdir(parents=True)
    names = [f"{joint}.pos" for joint in joints]
    features = {"observation.state": {"dtype": "float32", "shape": [len(joints)], "names": names}}
    (folder / "meta" / "info.json").write_text(json.dumps({"codebase_version": "v2.1", "features": features}))
    (folder / "calibration.json").write_text(json.dumps(calibration))
    places = [f"{i},{x},{y},{z}\n" for i, (x, y, z) in enumerate(board)]
    (folder / "board.csv").write_text("id,x,y,z\n" + "".join(places))
    (folder / "camera.yaml").write_text(
        "image_width: 640\nimage_height: 480\ndistortion_model: plumb_bob\n"
        "camera_matrix: {rows: 3, cols: 3, data: [500, 0, 320, 0, 500, 240, 0, 0, 1]}\n"
        "distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n"
    )
    seen_rows = ["episode_index,frame_index,id,u,v"]
    for episode in range(10):
        q = np.array([0.0, 0.3, 0.0, -0.9, 0.0, 0.6, 0.0]) + random.uniform(-0.6, 0.6, (8, 7))
        ticks = np.round((q - zeros) * TICKS / 2 / np.pi)  # of servos, from the middle
        states = np.repeat(ticks / ranges * 200.0, 3, axis=0)  # each stands for three frames
        lines = ["episode_index,frame_index,observation.state"]
        lines += [f'{episode},{n},"{np.array2string(state, max_line_width=999)}"' for n, state in enumerate(states)]
        (data / f"episode_{episode:06d}.csv").write_text("\n".join(lines) + "\n")
        poses = robot.forward_kinematics(ticks * 2 * np.pi / TICKS + zeros, "gripper_link", joints=joints)
        corners = board @ np.swapaxes(poses[:, :3, :3], 1, 2) + poses[:, np.newaxis, :3, 3]
        camera = corners - [0.8, 0.005 * (episode == 4), 1.9]  # above the arm, looking down
        u, v = 320.0 - 500.0 * camera[..., 1] / -camera[..., 2], 240.0 - 500.0 * camera[..., 0] / -camera[..., 2]
        for n, i in np.argwhere((u > 0) & (u < 640) & (v > 0) & (v < 480)):
            noise = random.normal(0.0, 0.1, 2)
            seen_rows.append(f"{episode},{3 * n + 1},{i},{u[n, i] + noise[0]:.3f},{v[n, i] + noise[1]:.3f}")
    (folder / "features.csv").write_text("\n".join(seen_rows) + "\n")
    return [str(folder), str(folder / "calibration.json"), str(EXAMPLE), "normalized", str(folder / "output")]


def main(
    dataset: str, file: str, urdf: str, unit: str, output: str, make: str = "feetech", link: str = ""
) -> int:
    if unit not in ("degrees", "normalized"):
        raise kinecal.KinecalError(f"'{unit}' is not a unit of observation.state; use degrees or normalized")
    robot = with_camera(kinecal.Robot(urdf))
    calibration = motors_of(Path(file))
    episodes = samples_by_episode(Path(dataset), calibration, robot.joint_names, unit)
    everything = list(episodes.values())
    config = kinecal.init(robot, sum(everything[1:], everything[0]), arm=link or None)["calibrate.yaml"]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "robot.urdf").write_text(robot.urdf, encoding="utf-8")
        (folder / "calibrate.yaml").write_text(config, encoding="utf-8")
        kept = graded(episodes, folder / "robot.urdf", folder / "calibrate.yaml", folder)
        words: list[str | Path] = ["--urdf", folder / "robot.urdf", "--config", folder / "calibrate.yaml", "--force"]
        words += ["--output", output, "--samples", *(folder / f"episode_{episode:06d}.yaml" for episode in kept)]
        outcome, text = patched(Path(file), unit, make, *words)
    if not outcome:  # nothing was written
        print(outcome)
        return 2
    report = json.loads(Path(output, "report.json").read_text(encoding="utf-8"))
    print("verdict:", report["verdict"])
    for reason in report["reasons"]:
        print("  -", reason)
    after = json.loads(text)
    for parameter in report["parameters"]:
        if parameter["name"] in calibration:
            change = after[parameter["name"]]["homing_offset"] - calibration[parameter["name"]]["homing_offset"]
            zero, sigma = np.degrees(parameter["value"]), np.degrees(parameter["sigma"] or np.nan)
            print(f"  {parameter['name']:20} {zero:+8.3f} +- {sigma:.3f} deg   homing_offset {change:+d}")
    held = set(calibration) & set(robot.joint_names) - {parameter["name"] for parameter in report["parameters"]}
    if held:
        print("  not determined beside the camera's place and the board's:", ", ".join(sorted(held)))
    if report["verdict"] == "do not use":
        return 2
    Path(output, Path(file).name).write_text(text, encoding="utf-8")
    print("written:", Path(output, Path(file).name))
    return 0


if __name__ == "__main__":
    try:
        if len(sys.argv) > 1:
            sys.exit(main(*sys.argv[1:]))
        with tempfile.TemporaryDirectory() as example:
            sys.exit(main(*simulated(Path(example))))
    except kinecal.KinecalError as error:
        sys.exit(f"error: {error}")
