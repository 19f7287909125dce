"""What may be wrong with a robot: a configuration, built or read."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Union

from .errors import KinecalError

#: Axes of a frame, as configurations name them.
AXES = ("x", "y", "z", "roll", "pitch", "yaw")


@dataclass(frozen=True)
class Model:
    """A sensor, or an arm that knows where features are."""

    name: str  #: of the sensor in the samples
    type: str  #: "chain3d", "camera3d", "camera2d", ...
    frame: str  #: link that it is fixed to
    options: Mapping[str, Any] = field(default_factory=dict)  #: further keys, such as ``lens``

    def _as_dict(self) -> dict[str, Any]:
        return {"name": self.name, "type": self.type, "frame": self.frame, **self.options}


def Chain3d(name: str, frame: str, **options: Any) -> Model:
    """Features at known places on a link: an arm that holds them, a tracker."""
    return Model(name, "chain3d", frame, options)


def Camera3d(name: str, frame: str, **options: Any) -> Model:
    """A depth camera, whose features are points."""
    return Model(name, "camera3d", frame, options)


def Camera2d(name: str, frame: str, **options: Any) -> Model:
    """A camera, whose features are pixels."""
    return Model(name, "camera2d", frame, options)


@dataclass(frozen=True)
class Frame:
    """A frame that may be wrong: that of a joint, or one that the URDF does not have, such as a board on the flange."""

    name: str
    axes: Union[str, Sequence[str]] = AXES  #: those that are free; "x y z", or a list
    xyz: Sequence[float] | None = None  #: metres, where it begins
    rpy: Sequence[float] | None = None  #: radians, where it begins

    def __post_init__(self) -> None:
        axes = self.axes.split() if isinstance(self.axes, str) else list(self.axes)
        for axis in axes:
            if axis not in AXES:
                raise KinecalError(f"axes: '{axis}' is none of " + ", ".join(AXES))
        object.__setattr__(self, "axes", tuple(axes))


def free(*names: str, axes: Union[str, Sequence[str], None] = None) -> list[Union[str, Frame]]:
    """What may be wrong.

    Args:
        names: of joints, whose zeros are free, or parameters ("camera_fx"); with ``axes``, of frames.
        axes: free axes of these frames: "x y z roll pitch yaw", or a list.
    """
    if axes is None:
        return list(names)
    return [Frame(name, axes) for name in names]


@dataclass(frozen=True)
class Block:
    """An error block: a comparison of what two models observe, or one that its type defines."""

    name: str  #: for reports
    type: str  #: "chain3d_to_chain3d", "chain3d_to_camera2d", ...
    options: Mapping[str, Any]  #: its keys: ``model_a``, ``model_b``, ``sigma``, ``loss``

    def __init__(self, name: str, type: str, **options: Any) -> None:
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "type", type)
        object.__setattr__(self, "options", options)


@dataclass(frozen=True)
class Config:
    """A configuration, as calibrate.yaml has it.

    Args:
        models: sensors and arms.
        error_blocks: what is compared.
        free: names and frames that may be wrong, as :func:`free` gives them; empty: what the samples support is found.
        base_link: link in which measurements are compared.
        options: further keys of calibrate.yaml: ``bounds``, ``initial_values``, ``per_sample``.
    """

    models: Sequence[Model]
    error_blocks: Sequence[Block]
    free: Sequence[Union[str, Frame]] = ()
    base_link: str = "base_link"
    options: Mapping[str, Any] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """The keys of calibrate.yaml."""
        free = _flat(self.free)
        frames = [item for item in free if isinstance(item, Frame)]
        result: dict[str, Any] = {
            "base_link": self.base_link,
            "models": [model._as_dict() for model in self.models],
            "error_blocks": [
                {"name": block.name, "type": block.type, **block.options}
                for block in self.error_blocks
            ],
        }
        if free:
            result["free_params"] = [item for item in free if isinstance(item, str)]
            result["free_frames"] = [
                {"name": frame.name, **{axis: axis in frame.axes for axis in AXES}}
                for frame in frames
            ]
        initial = [_initial(frame) for frame in frames if frame.xyz is not None or frame.rpy is not None]
        if initial:
            result["free_frames_initial_values"] = initial
        return {**result, **self.options}


def _flat(free: Any) -> list[Union[str, Frame]]:
    """Names and frames; lists of them, as free() gives, too."""
    if isinstance(free, (str, Frame)):
        return [free]
    if not isinstance(free, Iterable):
        raise KinecalError(f"free: {free!r} is neither a name nor a Frame")
    return [item for part in free for item in _flat(part)]


def _initial(frame: Frame) -> dict[str, Any]:
    zero = (0.0, 0.0, 0.0)
    numbers = [*(zero if frame.xyz is None else frame.xyz), *(zero if frame.rpy is None else frame.rpy)]
    if len(numbers) != len(AXES):
        raise KinecalError(f"frame '{frame.name}': xyz and rpy are three numbers each")
    return {"name": frame.name, **{axis: float(x) for axis, x in zip(AXES, numbers)}}


#: What stands for a configuration: built, a dict, a file, or the text of YAML.
AnyConfig = Union[Config, Mapping[str, Any], str, "os.PathLike[str]"]


def is_text(config: str) -> bool:
    """True for YAML, false for the name of a file."""
    return "\n" in config or ": " in config or config.lstrip().startswith("{")


def config_text(config: AnyConfig | None) -> tuple[str | None, str]:
    """Text of a configuration and its name in messages; None: the one that the samples suggest."""
    if config is None:
        return None, "the configuration"
    if isinstance(config, Config):
        config = config.to_dict()
    if isinstance(config, Mapping):
        try:
            return json.dumps(config, indent=1) + "\n", "the configuration"
        except (TypeError, ValueError) as error:
            raise KinecalError(f"the configuration: {error}") from None
    if not isinstance(config, (str, os.PathLike)) or str(config) == "":
        raise KinecalError(f"the configuration: {config!r} is neither a file, YAML, a dict nor a Config")
    text = str(os.fspath(config))
    if is_text(text):
        return text, "the configuration"
    try:
        return Path(text).read_text(encoding="utf-8"), text
    except (OSError, UnicodeDecodeError) as error:
        raise KinecalError(f"{text}: cannot be read: {error}") from None
