"""Samples: what was measured in each pose of the robot."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from . import _kinecal
from .errors import KinecalError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Array, Integers


_SIZES = {"points": (3,), "pixels": (2,), "poses": (4, 4)}


class Samples:
    """Poses of a robot and what its sensors observed in each.

    Args:
        positions: (n, joints) of the joints, radians or metres; or arrays (n) by name.
        joints: names of the columns of ``positions``; not with arrays by name.
        points: by sensor, (n, k, 3) measured points, metres, in the sensor's frame; (k, 3) if they are the same in each
            pose, such as corners of a board on the flange. NaN: not seen.
        pixels: by sensor, (n, k, 2) pixels of a camera. NaN: not seen.
        poses: by sensor, (n, 4, 4) measured poses, or (n, k, 4, 4). NaN: not seen.
        frames: by sensor, the link or frame in which its features are given.
        ids: by sensor, (k) numbers that identify its features, such as corners of a board; without them, the k-th feature
            of a sensor is the k-th of all others.
        cameras: by sensor, its intrinsics: a file, or ``{"K": (3, 3), "D": (d), "width": ..., "height": ...}``, with
            ``distortion_model`` as camera_info names it ("plumb_bob").
        conditions: by name, (n) further numbers of a sample: temperature, run.
        stamps: (n) seconds.
        name: for messages.

    Raises:
        KinecalError: for another shape or type, NaN among positions, a sensor without a frame.
    """

    def __init__(
        self,
        positions: ArrayLike | Mapping[str, ArrayLike],
        joints: Sequence[str] | None = None,
        *,
        points: Mapping[str, ArrayLike] | None = None,
        pixels: Mapping[str, ArrayLike] | None = None,
        poses: Mapping[str, ArrayLike] | None = None,
        frames: Mapping[str, str] | None = None,
        ids: Mapping[str, Sequence[int]] | None = None,
        cameras: Mapping[str, str | os.PathLike[str] | Mapping[str, Any]] | None = None,
        conditions: Mapping[str, ArrayLike] | None = None,
        stamps: ArrayLike | None = None,
        name: str = "samples",
    ) -> None:
        from .arrays import by_name, finite, shaped

        names, rows = _positions(positions, joints)
        finite(rows, f"{name}.positions", names)
        given = [
            (kind, by_name(arrays, kind))
            for kind, arrays in (("points", points), ("pixels", pixels), ("poses", poses))
        ]
        known = {sensor for _, arrays in given for sensor in arrays}
        for what, by_sensor in (("frames", frames), ("ids", ids), ("cameras", cameras)):
            for sensor in by_name(by_sensor, what):
                if sensor not in known:
                    raise KinecalError(f"{what}: '{sensor}' has neither points, pixels nor poses")
        sensors = []
        for kind, arrays in given:
            for sensor, array in arrays.items():
                features = _features(array, kind, sensor, len(rows))
                frame = (frames or {}).get(sensor)
                if not isinstance(frame, str) or not frame:
                    raise KinecalError(
                        f"frames: '{sensor}' is missing: the link in which its {kind} are given"
                    )
                camera = (cameras or {}).get(sensor)
                sensors.append(_sensor(sensor, frame, features, (ids or {}).get(sensor), camera))
        by_condition = {
            key: shaped(array, f"conditions['{key}']", (len(rows),))
            for key, array in by_name(conditions, "conditions").items()
        }
        times = None if stamps is None else shaped(stamps, "stamps", (len(rows),))
        self._arrays: _kinecal.SampleArrays | None = _kinecal.SampleArrays(
            names, rows, sensors, by_condition, times, name
        )
        self._list: _kinecal.Samples | None = None

    @property
    def _samples(self) -> _kinecal.Samples:
        """As the library has them; arrays are copied when somebody asks."""
        if self._list is None:
            assert self._arrays is not None
            self._list = self._arrays.samples()
        return self._list

    @classmethod
    def read(
        cls,
        *files: str | os.PathLike[str],
        cameras: Mapping[str, str | os.PathLike[str] | Mapping[str, Any]] | None = None,
    ) -> Samples:
        """Samples of files, in any format that kinecal reads: YAML, bags, MCAP, tables with columns.yaml.

        Args:
            cameras: by sensor, intrinsics of one that was recorded without, as of :class:`Samples`.

        Raises:
            KinecalError: with file and line of each error.
        """
        if not files:
            raise KinecalError("Samples.read(): at least one file is needed")
        samples = _kinecal.read_samples([os.fspath(file) for file in files])
        for sensor, camera in (cameras or {}).items():
            samples.set_camera(sensor, _camera(sensor, camera))
        return cls._of(samples)

    @classmethod
    def from_records(
        cls, records: Iterable[Mapping[str, Any]], *, frames: Mapping[str, str], **others: Any
    ) -> Samples:
        """Samples of one dict each.

        Args:
            records: ``{"positions": {"elbow": 0.3}, "points": {"camera": (k, 3)}, "pixels": ..., "poses": ...,
                "conditions": {"temperature": 21.0}}``; sensors that a sample lacks did not see anything.
            frames: see :class:`Samples`.
            others: ``ids``, ``cameras``, ``name``, see :class:`Samples`.
        """
        import numpy as np

        rows = list(records)
        if not rows:
            raise KinecalError("records: there are none")
        for i, row in enumerate(rows):
            if not isinstance(row, Mapping):
                raise KinecalError(f"records:{i + 1}: is {type(row).__name__}, not a dict")
        joints = list(rows[0].get("positions", {}))
        table = np.full((len(rows), len(joints)), np.nan)
        for i, row in enumerate(rows):
            unknown = set(row) - {"positions", "conditions", *_SIZES}
            if unknown:
                raise KinecalError(f"records:{i + 1}: '{sorted(unknown)[0]}' is no key of a record")
            if set(row.get("positions", {})) != set(joints):
                raise KinecalError(f"records:{i + 1}: has other joints than the first record")
            table[i] = [row["positions"][joint] for joint in joints]
        return cls(
            table,
            joints,
            points=_padded(rows, "points"),
            pixels=_padded(rows, "pixels"),
            poses=_padded(rows, "poses"),
            conditions=_conditions(rows),
            frames=frames,
            **others,
        )

    @classmethod
    def _of(cls, samples: _kinecal.Samples) -> Samples:
        new = cls.__new__(cls)
        new._arrays, new._list = None, samples
        return new

    @property
    def joints(self) -> list[str]:
        """Joints whose positions were measured."""
        return self._samples.joints()

    @property
    def sensors(self) -> list[str]:
        """Sensors that observed something."""
        return self._samples.sensors()

    @property
    def positions(self) -> Array:
        """(n, joints) positions of :attr:`joints`, radians or metres; NaN: not measured."""
        return self._samples.positions(self.joints)

    @property
    def sources(self) -> list[str]:
        """Where each comes from: "samples.yaml:37"."""
        return self._samples.sources()

    def features(self, sensor: str) -> tuple[Array, Integers]:
        """What a sensor observed.

        Returns:
            (n, k, 3) points, metres, or pixels (u, v, 0), NaN where it observed less; and (n, k) ids, -1 without one.
        """
        if sensor not in self.sensors:
            raise KinecalError(f"'{sensor}' observed nothing; " + ", ".join(self.sensors))
        return self._samples.features(sensor)

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes them: samples in YAML, or a bag (.bag, .mcap, .db3)."""
        self._samples.save(os.fspath(file))

    def __len__(self) -> int:
        return len(self._samples) if self._arrays is None else len(self._arrays)

    @overload
    def __getitem__(self, index: int) -> Samples: ...
    @overload
    def __getitem__(self, index: slice) -> Samples: ...
    @overload
    def __getitem__(self, index: ArrayLike) -> Samples: ...
    def __getitem__(self, index: Any) -> Samples:
        """Some of them: by number, slice, numbers or mask."""
        import numpy as np

        chosen = np.atleast_1d(np.arange(len(self))[index])
        return Samples._of(self._samples.take([int(i) for i in chosen]))

    def __iter__(self) -> Iterator[Samples]:
        return (self[i] for i in range(len(self)))

    def __add__(self, other: Samples) -> Samples:
        if not isinstance(other, Samples):
            return NotImplemented
        both = self._samples.take(list(range(len(self))))
        both.append(other._samples)
        return Samples._of(both)

    def __radd__(self, nothing: int) -> Samples:  # sum() begins with 0
        if nothing != 0:
            return NotImplemented
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return _samples_from, (_as_bytes(self),)

    def __repr__(self) -> str:
        seen = ", ".join(self.sensors) or "nothing observed"
        return f"<Samples: {len(self)} of {len(self.joints)} joints; {seen}>"


def _camera(sensor: str, camera: str | os.PathLike[str] | Mapping[str, Any]) -> _kinecal.Camera:
    if not isinstance(camera, Mapping):
        return _kinecal.Camera(os.fspath(camera))
    from .arrays import numbers, shaped

    where = f"cameras['{sensor}']"
    missing = [key for key in ("K", "width", "height") if key not in camera]
    if missing:
        raise KinecalError(f"{where}: '{missing[0]}' is missing")
    unknown = set(camera) - {"K", "D", "width", "height", "distortion_model"}
    if unknown:
        raise KinecalError(f"{where}: '{min(map(str, unknown))}' is no key of a camera")
    k = shaped(camera["K"], f"{where}['K']", (3, 3))
    if k[0, 1] != 0 or k[1, 0] != 0 or list(k[2]) != [0, 0, 1] or not (k[0, 0] > 0 and k[1, 1] > 0):
        raise KinecalError(f"{where}['K']: [[fx, 0, cx], [0, fy, cy], [0, 0, 1]] is expected")
    d = numbers(camera.get("D", []), f"{where}['D']").ravel()
    model = str(camera.get("distortion_model", "plumb_bob" if len(d) > 0 else ""))
    if model not in ("", "plumb_bob", "rational_polynomial", "equidistant", "fisheye"):
        raise KinecalError(f"{where}: '{model}' is no distortion_model; plumb_bob, rational_polynomial, equidistant")
    width, height = (_integer(camera[side], f"{where}['{side}']", 1) for side in ("width", "height"))
    if not (0 < k[0, 2] < width and 0 < k[1, 2] < height):
        raise KinecalError(f"{where}: cx, cy = {k[0, 2]}, {k[1, 2]} is outside of {width} x {height} pixels")
    values = [k[0, 0], k[1, 1], k[0, 2], k[1, 2], *d]
    return _kinecal.Camera(width, height, [float(value) for value in values], model)


def _integer(value: Any, name: str, least: int) -> int:
    """A number without a fraction that fits into 32 bits."""
    try:
        number = int(value)
        is_whole = number == value
    except (TypeError, ValueError, OverflowError):
        is_whole = False
    if not is_whole or not least <= number < 2**31:
        raise KinecalError(f"{name}: {value!r} is no whole number from {least} on")
    return number


def _positions(
    positions: ArrayLike | Mapping[str, ArrayLike], joints: Sequence[str] | None
) -> tuple[list[str], Array]:
    import numpy as np

    from .arrays import names as checked
    from .arrays import shaped

    if isinstance(positions, Mapping):
        if joints is not None:
            raise KinecalError("joints: positions have names already")
        names = checked(positions, "positions")
        columns = [shaped(positions[name], f"positions['{name}']", ("n",)) for name in names]
        if len({len(column) for column in columns}) > 1:
            raise KinecalError("positions: arrays of different lengths")
        return names, np.stack(columns, axis=1) if columns else np.zeros((0, 0))
    if joints is None:
        raise KinecalError("joints: the names of the columns of positions are needed")
    names = checked(joints, "joints")
    return names, shaped(positions, "positions", ("n", len(names)))


def _features(array: ArrayLike, kind: str, sensor: str, count: int) -> Array:
    """(n, k, ...) of what a sensor observed."""
    import numpy as np

    from .arrays import numbers

    size = _SIZES[kind]
    features = numbers(array, f"{kind}['{sensor}']")
    if kind == "poses" and features.ndim == 3:
        features = features[:, np.newaxis]
    same = features.ndim == len(size) + 1 and kind != "poses"  # in each pose
    if same:
        features = features[np.newaxis]
    rows = 1 if same else count
    if features.ndim != len(size) + 2 or features.shape[0] != rows or features.shape[2:] != size:
        wanted = ", ".join(str(n) for n in (count, "k", *size))
        shape = np.shape(array)
        raise KinecalError(f"{kind}['{sensor}']: has shape {shape}; ({wanted}) is expected")
    if np.isinf(features).any():
        row = int(np.argwhere(np.isinf(features))[0][0])
        raise KinecalError(f"{kind}['{sensor}']:{row + 1}: is infinite; NaN means not seen")
    if kind == "poses":
        _check_rotations(features, sensor)
    return features


def _check_rotations(poses: Array, sensor: str) -> None:
    import numpy as np

    seen = np.where(np.isnan(poses).any(axis=(-1, -2), keepdims=True), np.eye(4), poses)
    rotations = seen[..., :3, :3]
    products = rotations @ np.swapaxes(rotations, -1, -2) - np.eye(3)
    wrong = (np.abs(products).max(axis=(-1, -2)) > 1e-3) | (np.linalg.det(rotations) < 0)
    if wrong.any():
        row = int(np.argwhere(wrong)[0][0])
        raise KinecalError(f"poses['{sensor}']:{row + 1}: its upper left is no rotation")
    wrong = (np.abs(seen[..., 3, :] - [0.0, 0.0, 0.0, 1.0]) > 1e-6).any(axis=-1)
    if wrong.any():
        row = int(np.argwhere(wrong)[0][0])
        raise KinecalError(f"poses['{sensor}']:{row + 1}: its last row is not 0 0 0 1")


def _sensor(
    sensor: str,
    frame: str,
    features: Array,
    ids: Sequence[int] | None,
    camera: str | os.PathLike[str] | Mapping[str, Any] | None,
) -> _kinecal.SensorArray:
    numbers = [] if ids is None else [_integer(i, f"ids['{sensor}']", 0) for i in ids]
    if ids is not None and len(numbers) != features.shape[1]:
        raise KinecalError(f"ids['{sensor}']: {len(numbers)} for {features.shape[1]} features")
    if len(set(numbers)) != len(numbers):
        raise KinecalError(f"ids['{sensor}']: the same id twice")
    intrinsics = None if camera is None else _camera(sensor, camera)
    return _kinecal.SensorArray(sensor, frame, features, numbers, intrinsics)


def _padded(rows: list[Mapping[str, Any]], kind: str) -> dict[str, Array]:
    """Features of records as arrays, with NaN where a sample has fewer."""
    import numpy as np

    from .arrays import numbers

    size = _SIZES[kind]
    sensors = list(dict.fromkeys(sensor for row in rows for sensor in row.get(kind, {})))
    padded = {}
    for sensor in sensors:
        seen = []
        for i, row in enumerate(rows):
            one = numbers(row.get(kind, {}).get(sensor, np.zeros((0, *size))), f"records:{i + 1}")
            one = one[np.newaxis] if one.ndim == len(size) else one
            if one.shape[1:] != size:
                raise KinecalError(f"records:{i + 1}: {kind} of '{sensor}' have shape {one.shape}")
            seen.append(one)
        array = np.full((len(rows), max(len(one) for one in seen), *size), np.nan)
        for i, one in enumerate(seen):
            array[i, : len(one)] = one
        padded[sensor] = array
    return padded


def _conditions(rows: list[Mapping[str, Any]]) -> dict[str, list[float]]:
    names = dict.fromkeys(name for row in rows for name in row.get("conditions", {}))
    return {
        name: [float(row.get("conditions", {}).get(name, float("nan"))) for row in rows]
        for name in names
    }


def _as_bytes(samples: Samples) -> bytes:
    if len(samples) == 0:
        return b""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "samples.mcap"
        samples.save(file)
        return file.read_bytes()


def _samples_from(content: bytes) -> Samples:
    if not content:
        return Samples({})
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "samples.mcap"
        file.write_bytes(content)
        return Samples.read(file)
