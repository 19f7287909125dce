"""kinecal: calibration of robots. Arrays or files in, a corrected URDF and a verdict out.

    import kinecal

    robot = kinecal.Robot("robot.urdf")
    samples = kinecal.Samples.read("samples.yaml")
    result = kinecal.calibrate(robot, samples, "calibrate.yaml")
    print(result)                       # the verdict, its reasons, each parameter with its +-
    result.save("calibrated")           # calibrated.urdf, camera files, report

Lengths are metres, angles radians, features of cameras pixels. Whatever is wrong with the input is a
:class:`KinecalError`, with file and line where there is one.
"""

from ._kinecal import __version__
from .calibration import Parameter, Residuals, Result, calibrate
from .config import Block, Camera2d, Camera3d, Chain3d, Config, Frame, Model, free
from .errors import KinecalError
from .program import (
    Outcome,
    compare,
    detect,
    evaluate,
    grade,
    identify,
    init,
    plan,
    run,
    select_poses,
    simulate,
    verify,
)
from .robot import Joint, Robot
from .samples import Samples

__all__ = [
    "Block",
    "Camera2d",
    "Camera3d",
    "Chain3d",
    "Config",
    "Frame",
    "Joint",
    "KinecalError",
    "Model",
    "Outcome",
    "Parameter",
    "Residuals",
    "Result",
    "Robot",
    "Samples",
    "__version__",
    "calibrate",
    "compare",
    "detect",
    "evaluate",
    "free",
    "grade",
    "identify",
    "init",
    "plan",
    "run",
    "select_poses",
    "simulate",
    "verify",
]
