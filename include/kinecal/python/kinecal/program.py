"""What the program does beside calibrating: each function runs one of its commands and gives back what it writes."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

from . import _kinecal
from .calibration import Result, calibrate
from .config import AnyConfig, Config, config_text, is_text
from .errors import KinecalError
from .robot import Robot
from .samples import Samples

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

#: A result: of :func:`calibrate`, or the folder of one.
AnyResult = Union[Result, str, "os.PathLike[str]"]
#: A robot, or its URDF.
AnyRobot = Union[Robot, str, "os.PathLike[str]"]
#: Samples, or files of them.
AnySamples = Union[Samples, str, "os.PathLike[str]", Sequence[Union[str, "os.PathLike[str]"]]]


@dataclass(frozen=True)
class Outcome:
    """What a command says."""

    code: int  #: 0: done; 2: a result that does not hold, or an answer "no"
    text: str  #: what it prints
    report: dict[str, Any] = field(default_factory=dict)  #: the same for programs

    def __bool__(self) -> bool:
        return self.code == 0

    def __str__(self) -> str:
        return self.text


def program() -> str:
    """The program: $KINECAL, beside this package, or on the PATH.

    Raises:
        KinecalError: if there is none.
    """
    here = Path(__file__).resolve().parent  # of a wheel, of a build tree, of Debian's packages
    folders = [here, *(here.parents[i] for i in (1, 3) if i < len(here.parents))]
    beside = [str(folder / "bin" / "kinecal") for folder in folders]
    chosen = os.environ.get("KINECAL")
    for place in [chosen] if chosen else [*beside, shutil.which("kinecal") or ""]:
        if place and os.access(place, os.X_OK) and Path(place).is_file():
            return place
    if chosen:
        raise KinecalError(f"{chosen}: is no program; KINECAL in the environment names it")
    raise KinecalError("the program 'kinecal' is not found: install it, or set KINECAL to its file")


def run(*arguments: str | os.PathLike[str]) -> Outcome:
    """Runs a command of the program: ``run("inspect", "run.bag")``.

    Raises:
        KinecalError: what the program says of its input.
    """
    words = [program(), *(os.fspath(argument) for argument in arguments)]
    done = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 2):
        lines = [line.removeprefix("error: ") for line in done.stderr.splitlines() if line]
        errors = [line for line in lines if not line.startswith(("warning: ", "note: ", "doubt: "))]
        raise KinecalError("\n".join(errors) or f"kinecal {words[1]}: exit code {done.returncode}")
    return Outcome(done.returncode, done.stdout)


def _folder() -> tempfile.TemporaryDirectory[str]:
    """A folder that is removed afterwards."""
    return tempfile.TemporaryDirectory(prefix="kinecal-")


class _Call:
    """A command with files of its own in a folder."""

    def __init__(self, folder: str) -> None:
        self.folder = Path(folder)

    def result(self, result: AnyResult, name: str) -> str:
        if isinstance(result, Result):
            return str(result.save(self.folder / name))
        return os.fspath(result)

    def samples(self, samples: AnySamples, name: str = "samples") -> list[str]:
        if isinstance(samples, Samples):
            samples.save(self.folder / f"{name}.yaml")
            return [str(self.folder / f"{name}.yaml")]
        if isinstance(samples, (str, os.PathLike)):
            return [os.fspath(samples)]
        return [os.fspath(file) for file in samples]

    def robot(self, robot: AnyRobot) -> str:
        if isinstance(robot, Robot):
            return robot._path or self.text("robot.urdf", robot.urdf)
        text = os.fspath(robot)
        return self.text("robot.urdf", text) if "<" in text else text

    def config(self, config: AnyConfig, name: str = "calibrate.yaml") -> str:
        if isinstance(config, (str, os.PathLike)) and not is_text(str(config)):
            return str(os.fspath(config))
        text, _ = config_text(config)
        return self.text(name, text or "")

    def text(self, name: str, text: str) -> str:
        (self.folder / name).write_text(text, encoding="utf-8")
        return str(self.folder / name)

    def run(self, *arguments: str, report: bool = False) -> Outcome:
        if not report:
            return run(*arguments)
        file = self.folder / "report.json"
        done = run(*arguments, "--report", file)
        return Outcome(done.code, done.text, json.loads(file.read_text(encoding="utf-8")))

    def flags(self, options: Mapping[str, Any]) -> list[str]:
        """Options of the program: ``count=30, keep_outliers=True`` are ``--count 30 --keep-outliers``."""
        words = []
        for name, value in options.items():
            if value is None or value is False:
                continue
            words.append("--" + name.replace("_", "-"))
            if value is not True:
                words += self.words(value, name)
        return words

    def words(self, value: Any, name: str) -> list[str]:
        if isinstance(value, Robot):
            return [self.robot(value)]
        if isinstance(value, Result):
            return [self.result(value, name)]
        if isinstance(value, (Config, Mapping)):
            return [self.config(value, f"{name}.yaml")]
        if isinstance(value, Samples):
            return self.samples(value, name)
        if isinstance(value, Sequence) and not isinstance(value, str):
            return [word for item in value for word in self.words(item, name)]
        return [str(value)]


def identify(robot: AnyRobot, samples: AnySamples, config: AnyConfig | None = None, **options: Any) -> Result:
    """Finds out what is wrong with a robot: what the samples support is freed and calibrated.

    ``result.report["search"]`` has the steps, ``result.config`` the configuration that was found; ``options`` are those
    of :func:`calibrate`.
    """
    if not isinstance(robot, Robot):
        robot = Robot(robot)
    if not isinstance(samples, Samples):
        files = [samples] if isinstance(samples, (str, os.PathLike)) else samples
        samples = Samples.read(*files)
    return calibrate(robot, samples, config, search=True, **options)


def verify(result: AnyResult, samples: AnySamples, **options: Any) -> Outcome:
    """Whether a result still holds, by a few new samples; ``bool(outcome)`` is the answer.

    Args:
        options: of ``kinecal verify``.
    """
    with _folder() as own:
        call = _Call(own)
        words = ["verify", call.result(result, "result"), *call.samples(samples), *call.flags(options)]
        return call.run(*words, report=True)


def evaluate(result: AnyResult, samples: AnySamples, **options: Any) -> Outcome:
    """How a result fits other samples, without solving; ``options`` are those of ``kinecal evaluate``."""
    with _folder() as own:
        call = _Call(own)
        words = ["evaluate", call.result(result, "result"), *call.samples(samples), *call.flags(options)]
        return call.run(*words, report=True)


def compare(earlier: AnyResult, later: AnyResult, **options: Any) -> Outcome:
    """Which parameters of two results differ by more than chance explains; ``options`` are those of ``kinecal compare``."""
    with _folder() as own:
        call = _Call(own)
        words = ["compare", call.result(earlier, "earlier"), call.result(later, "later"), *call.flags(options)]
        return call.run(*words, report=True)


@dataclass(frozen=True)
class Poses(Outcome):
    """Poses that were chosen."""

    samples: Samples | None = None  #: their positions, without observations; None: no poses reach what was asked for


def _poses(command: str, robot: AnyRobot, config: AnyConfig | None, samples: AnySamples | None, options: Any) -> Poses:
    with _folder() as own:
        call = _Call(own)
        output = call.folder / "poses.yaml"
        words = [command, "--urdf", call.robot(robot), "--output", str(output)]
        if config is not None:
            words += ["--config", call.config(config)]
        if samples is not None:
            words += ["--samples", *call.samples(samples)]
        done = call.run(*words, *call.flags(options))
        chosen = Samples._of(_kinecal.read_poses(str(output))) if output.exists() else None
        return Poses(done.code, done.text, {}, chosen)


def plan(robot: AnyRobot, config: AnyConfig | None = None, samples: AnySamples | None = None, **options: Any) -> Poses:
    """How many poses, and which, an accuracy needs: ``plan(robot, config, accuracy="gripper 1 mm")``.

    Args:
        config: what is calibrated; None: a first configuration, as of :func:`init`.
        samples: recorded ones, whose poses and targets are used.
        options: of ``kinecal plan``.
    """
    return _poses("plan", robot, config, samples, options)


def select_poses(
    robot: AnyRobot, config: AnyConfig | None = None, samples: AnySamples | None = None, **options: Any
) -> Poses:
    """Few poses of many, so that a calibration is as good as possible; ``options`` are those of ``kinecal select-poses``."""
    return _poses("select-poses", robot, config, samples, options)


def detect(
    target: AnyConfig,
    images: str | os.PathLike[str] | Sequence[ArrayLike] | None = None,
    poses: str | os.PathLike[str] | Sequence[Mapping[str, float]] | None = None,
    **options: Any,
) -> Samples:
    """Finds boards and tags in images, or in recordings.

    Args:
        target: what to look for: capture.yaml, its text, or a dict.
        images: folder, or arrays (height, width) or (height, width, 3) of uint8, BGR as OpenCV has them.
        poses: table of joint positions, or those of each image by joint; None: there is no robot.
        options: of ``kinecal detect``: ``bag``, ``camera``, ``frame``.
    """
    with _folder() as own:
        call = _Call(own)
        output = call.folder / "found.yaml"
        words = ["detect", call.config(target, "capture.yaml"), "--output", str(output)]
        if images is not None:
            words += ["--images", _image_folder(images, call)]
        if poses is not None:
            words += ["--poses", _pose_table(poses, call)]
        call.run(*words, *call.flags(options))
        return Samples.read(output)


def simulate(robot: AnyRobot, folder: str | os.PathLike[str], **options: Any) -> Path:
    """Simulates a robot that differs from its URDF by known errors, and what its camera sees.

    Args:
        folder: for images, tables and the truth.
        options: of ``kinecal simulate``: ``target``, ``poses``, ``seed``.

    Returns:
        The folder.
    """
    with _folder() as own:
        call = _Call(own)
        call.run("simulate", call.robot(robot), "--output", os.fspath(folder), *call.flags(options))
        return Path(folder)


def init(robot: AnyRobot | None = None, samples: AnySamples | None = None, **options: Any) -> dict[str, str]:
    """First configurations: calibrate.yaml, and capture.yaml or columns.yaml where they are needed.

    Args:
        robot: None: ``poses`` or ``cameras`` among the options.
        samples: recorded ones or a table, whose names they take.
        options: of ``kinecal init``: ``target``, ``camera``, ``arm``.

    Returns:
        Texts by name of the file; ``calibrate(robot, samples, texts["calibrate.yaml"])``.
    """
    with _folder() as own:
        call = _Call(own)
        made = call.folder / "made"
        made.mkdir()
        words = ["init", "--output", str(made / "calibrate.yaml")]
        if robot is not None:
            words += ["--urdf", call.robot(robot)]
        if samples is not None:
            words += ["--from", *call.samples(samples)]
        call.run(*words, *call.flags(options))
        return {file.name: file.read_text(encoding="utf-8") for file in sorted(made.iterdir())}


def grade(episodes: Sequence[str | os.PathLike[str]] | str | os.PathLike[str], **options: Any) -> Outcome:
    """Episodes of a data set in which the camera or a zero is not as in the others; ``options`` are those of
    ``kinecal grade``."""
    with _folder() as own:
        call = _Call(own)
        files = [episodes] if isinstance(episodes, (str, os.PathLike)) else list(episodes)
        return call.run("grade", *(os.fspath(file) for file in files), *call.flags(options), report=True)


def _image_folder(images: str | os.PathLike[str] | Sequence[ArrayLike], call: _Call) -> str:
    if isinstance(images, (str, os.PathLike)):
        return os.fspath(images)
    folder = call.folder / "images"
    folder.mkdir()
    for i, image in enumerate(images):
        (folder / f"{i:06d}.bmp").write_bytes(_bitmap(image, i))
    return str(folder)


def _bitmap(image: ArrayLike, number: int) -> bytes:
    """An image as BMP, without compression."""
    import struct

    import numpy as np

    pixels = np.asarray(image)
    if pixels.dtype != np.uint8 or pixels.ndim not in (2, 3) or pixels.shape[2:] not in ((), (3,)):
        raise KinecalError(
            f"images:{number + 1}: {pixels.dtype} of shape {pixels.shape}; uint8 of (height, width) or (height, width, 3)"
        )
    if pixels.ndim == 2:
        pixels = np.repeat(pixels[:, :, np.newaxis], 3, axis=2)
    height, width = pixels.shape[:2]
    rows = np.zeros((height, (3 * width + 3) // 4 * 4), dtype=np.uint8)
    rows[:, : 3 * width] = pixels[::-1].reshape(height, 3 * width)
    head = struct.pack("<2sIHHI", b"BM", 54 + rows.size, 0, 0, 54)
    return head + struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, rows.size, 0, 0, 0, 0) + rows.tobytes()


def _pose_table(poses: str | os.PathLike[str] | Sequence[Mapping[str, float]], call: _Call) -> str:
    if isinstance(poses, (str, os.PathLike)):
        return os.fspath(poses)
    joints = list(poses[0]) if poses else []
    lines = [",".join(["image", *joints])]
    for i, pose in enumerate(poses):
        if set(pose) != set(joints):
            raise KinecalError(f"poses:{i + 1}: has other joints than the first")
        lines.append(",".join([f"{i:06d}.bmp", *(repr(float(pose[joint])) for joint in joints)]))
    return call.text("poses.csv", "\n".join(lines) + "\n")
