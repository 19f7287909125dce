"""Calibration: samples in, the corrected robot and a verdict out."""

from __future__ import annotations

import datetime
import html
import json
import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _kinecal
from .config import AnyConfig, config_text
from .errors import KinecalError
from .robot import Robot
from .samples import Samples

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from .arrays import Array

Progress = Callable[[str, int, float], Any]

#: As OffsetStyle and Reader of the library number them.
_OFFSETS = ("", "origin", "rising", "ros2_control")
_READERS = ("", "driver", "urdf", "origins")

#: Arrays of more samples are calibrated part by part, as ``kinecal calibrate-log`` does: they are not copied.
_MANY = 50_000
_ROWS = 10_000  #: of a part


@dataclass(frozen=True)
class Parameter:
    """A number that was calibrated."""

    name: str
    unit: str  #: "rad", "m", "1" or "px"
    before: float
    after: float
    sigma: float  #: one standard deviation; NaN: not determined

    @property
    def change(self) -> float:
        """After minus before."""
        return self.after - self.before


@dataclass(frozen=True)
class Residuals:
    """Residuals of an error block, one row for each feature."""

    unit: str  #: "m", "px" or "1"
    sample: NDArray[np.intc]  #: (n) from 0
    feature: NDArray[np.intc]  #: (n) id, or place in the list of the sensor
    left_out: NDArray[np.bool_]  #: (n) the sample does not count
    before: Array  #: (n) distance before calibration
    after: Array  #: (n) distance after it
    residual: Array  #: (n, components) after it


class Result:
    """A calibrated robot, and how good it is. It can be pickled; ``print()`` shows the report."""

    def __init__(self, calibrated: _kinecal.Calibrated, mesh_paths: Sequence[str] = ()) -> None:
        self._calibrated: _kinecal.Calibrated | None = calibrated
        self._kept: dict[str, Any] = {}
        self._mesh_paths = list(mesh_paths)

    def _get(self, name: str) -> Any:
        if name not in self._kept:
            assert self._calibrated is not None
            self._kept[name] = getattr(self._calibrated, name)()
        return self._kept[name]

    @property
    def report(self) -> dict[str, Any]:
        """All figures, as report.json has them."""
        if "report" not in self._kept:
            self._kept["report"] = json.loads(self._get("json"))
        report: dict[str, Any] = self._kept["report"]
        return report

    @property
    def verdict(self) -> str:
        """ "good", "use with care" or "do not use"."""
        verdict: str = self.report["verdict"]
        return verdict

    @property
    def is_usable(self) -> bool:
        """False if the verdict is "do not use"."""
        return self.verdict != "do not use"

    @property
    def reasons(self) -> list[str]:
        """Reasons for the verdict: causes first, then the worst."""
        return list(self.report["reasons"])

    @property
    def causes(self) -> list[str]:
        """Those of the reasons that explain the others."""
        return self.reasons[: int(self._get("causes"))]

    @property
    def next(self) -> str:
        """What to do next."""
        text: str = self._get("next")
        return text

    @property
    def warnings(self) -> list[str]:
        """What was noticed in the input and does not change the result."""
        return list(self._get("warnings"))

    @property
    def parameters(self) -> list[Parameter]:
        """What was calibrated; :meth:`to_frame` has it as a table."""
        return [
            Parameter(
                item["name"],
                item["unit"],
                item["initial"],
                item["value"],
                math.nan if item["sigma"] is None else item["sigma"],
            )
            for item in self.report["parameters"]
        ]

    def __getitem__(self, name: str) -> Parameter:
        """A parameter by name."""
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KinecalError(f"'{name}' was not calibrated")

    @property
    def covariance(self) -> Array:
        """(parameters, parameters) of :attr:`parameters`, in their units; zero along what the samples do not determine."""
        import numpy as np

        names = [parameter.name for parameter in self.parameters]
        matrix = np.zeros((len(names), len(names)))
        given = self.report["covariance"]
        if given:
            at = [names.index(name) for name in given["parameters"]]
            for i, row in enumerate(given["lower"]):
                for k, value in enumerate(row):
                    entry = math.nan if value is None else value
                    matrix[at[i], at[k]] = matrix[at[k], at[i]] = entry
        return matrix

    @property
    def residuals(self) -> dict[str, Residuals]:
        """Residuals by error block."""
        return {name: Residuals(**arrays) for name, arrays in self._get("residuals").items()}

    @property
    def urdf(self) -> str:
        """Text of the corrected URDF: calibrated.urdf of the program. Zeros of joints are where it has them already,
        else in ``<calibration rising>``, which :class:`Robot` does not read; :attr:`robot` has them in the origins."""
        text: str = self._get("urdf")
        return text

    @property
    def robot(self) -> Robot:
        """The corrected robot, with the zeros of its joints in their origins: its kinematics are what was measured."""
        return Robot(self._get("urdf_of_origins"))

    @property
    def files(self) -> dict[str, str]:
        """All files of the result by name, as the program writes them: calibrated.urdf, camera files, report.json."""
        return dict(self._get("files"))

    @property
    def cameras(self) -> dict[str, str]:
        """Camera files by name: YAML of camera_info."""
        return {
            name: text
            for name, text in self.files.items()
            if name.endswith(".yaml") and "camera_matrix" in text
        }

    @property
    def config(self) -> str:
        """The configuration, YAML; the one that was found where none was given."""
        text: str = self._get("config")
        return text

    def report_html(self) -> str:
        """The report as a page: charts, the robot in 3-D. It needs no other file."""
        if "page" not in self._kept:
            assert self._calibrated is not None
            today = datetime.date.today().isoformat()
            self._kept["page"] = self._calibrated.page(self._mesh_paths, today)
        page: str = self._kept["page"]
        return page

    def save(self, folder: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Writes the files into a folder, which ``kinecal install`` and ``kinecal verify`` take.

        Raises:
            KinecalError: if a file is there already and ``overwrite`` is False; nothing is written then.
        """
        path = Path(folder)
        files = self.files
        there = [name for name in files if (path / name).exists()]
        if there and not overwrite:
            raise KinecalError(f"{path / there[0]}: exists; save(..., overwrite=True) replaces it")
        _kinecal.write_folder(os.fspath(path), files)
        return path

    def to_frame(self) -> Any:
        """The parameters as a table of pandas."""
        import pandas  # type: ignore[import]

        rows = [
            {"name": p.name, "before": p.before, "after": p.after, "sigma": p.sigma, "unit": p.unit}
            for p in self.parameters
        ]
        return pandas.DataFrame(rows).set_index("name")

    def plot(self) -> Any:
        """Distances of all features before and after, as a figure of matplotlib."""
        from matplotlib import pyplot  # type: ignore[import]

        blocks = self.residuals
        figure, axes = pyplot.subplots(1, max(1, len(blocks)), squeeze=False)
        for axis, (name, block) in zip(axes[0], blocks.items()):
            scale, unit = (1e3, "mm") if block.unit == "m" else (1.0, block.unit)
            used = ~block.left_out
            axis.hist(scale * block.before[used], bins=40, alpha=0.5, label="before")
            axis.hist(scale * block.after[used], bins=40, alpha=0.5, label="after")
            axis.set(title=name, xlabel=unit)
            axis.legend()
        return figure

    def __getstate__(self) -> dict[str, Any]:
        for name in ("json", "causes", "next", "warnings", "residuals", "urdf", "urdf_of_origins"):
            self._get(name)
        for name in ("files", "config", "text"):
            self._get(name)
        self.report_html()
        return {"kept": {name: kept for name, kept in self._kept.items() if name != "report"}}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._calibrated, self._kept, self._mesh_paths = None, dict(state["kept"]), []

    def __str__(self) -> str:
        text: str = self._get("text")
        return text.rstrip("\n")

    def __repr__(self) -> str:
        return f"<Result: {self.verdict}, {len(self.parameters)} parameters>"

    def _repr_html_(self) -> str:
        reasons = "".join(f"<li>{html.escape(reason)}</li>" for reason in self.reasons)
        rows = "".join(
            f"<tr><td>{html.escape(p.name)}</td><td>{p.before:.6g}</td><td>{p.after:.6g}</td>"
            f"<td>± {p.sigma:.2g}</td><td>{p.unit}</td></tr>"
            for p in self.parameters
        )
        page = html.escape(self.report_html(), quote=True)
        return (
            f"<b>{html.escape(self.verdict)}</b><ul>{reasons}</ul>"
            "<table><tr><th>parameter</th><th>before</th><th>after</th><th></th><th>unit</th></tr>"
            f"{rows}</table>"
            f'<iframe srcdoc="{page}" style="width:100%;height:40em;border:0"></iframe>'
        )


def calibrate(
    robot: Robot | str | os.PathLike[str],
    samples: Samples | str | os.PathLike[str],
    config: AnyConfig | None = None,
    *,
    progress: Progress | None = None,
    threads: int = 0,
    starts: int = 0,
    folds: int = 5,
    keep_outliers: bool = False,
    exclude: Sequence[int] = (),
    hold: Sequence[str] = (),
    between: Sequence[str] = (),
    mesh_paths: Sequence[str | os.PathLike[str]] = (),
    search: bool = False,
    draw: int = 3000,
    offsets: str = "",
    reader: str = "",
) -> Result:
    """Calibrates a robot and judges the result, as ``kinecal calibrate`` does.

    More than 50 000 samples of arrays are calibrated as ``kinecal calibrate-log`` does: with all of them, judged on a draw.

    Args:
        robot: the robot, or its URDF.
        samples: the samples, or their file.
        config: what may be wrong: built, a dict, a file, or YAML; None: what the samples support is found.
        progress: called with (step, iteration, cost); what it raises ends the calibration.
        threads: 0: one per core. It does not affect the result.
        starts: random starts besides the one given.
        folds: of held-out errors; 0: as many as samples; 1: none.
        keep_outliers: no sample is left out.
        exclude: numbers of samples to leave out, from 0.
        hold: parameters, frames or joints that keep their values.
        between: sensors, links or frames; the report has the +- of the pose of one in another.
        mesh_paths: folders of the URDF's packages.
        search: find out what the samples support, even if the configuration frees something.
        draw: of more than 50 000 samples of arrays: those on which they are judged.
        offsets: where the URDF holds zeros: "origin", "rising" or "ros2_control"; "": where it has them already.
        reader: of the files, whose errors are judged: "driver", "urdf" or "origins"; "": urdf.

    Raises:
        KinecalError: with all errors of the input.
        KeyboardInterrupt: Ctrl-C stops a solve.
    """
    if not isinstance(robot, Robot):
        robot = Robot(robot)
    if isinstance(samples, (str, os.PathLike)):
        samples = Samples.read(samples)
    if not isinstance(samples, Samples):
        raise KinecalError(f"samples: Samples or a file are expected, not {type(samples).__name__}")
    if len(samples) == 0:
        raise KinecalError("samples: there are none")
    if offsets not in _OFFSETS:
        raise KinecalError(f"offsets: '{offsets}' is none of " + ", ".join(_OFFSETS))
    if reader not in _READERS:
        raise KinecalError(f"reader: '{reader}' is none of " + ", ".join(_READERS))
    for what, number in (("threads", threads), ("starts", starts), ("folds", folds), ("draw", draw)):
        if not isinstance(number, int) or number < 0:
            raise KinecalError(f"{what}: {number!r} is no whole number from 0 on")
    for what, listed in (("hold", hold), ("between", between), ("mesh_paths", mesh_paths)):
        if isinstance(listed, (str, bytes)):
            raise KinecalError(f"{what}: a list is expected, not {listed!r}")
    text, name = config_text(config)
    paths = [os.fspath(path) for path in mesh_paths]
    options: Mapping[str, Any] = {
        "threads": threads,
        "starts": starts,
        "folds": folds,
        "keep_outliers": keep_outliers,
        "exclude": [number + 1 for number in exclude],
        "hold": list(hold),
        "between": list(between),
        "mesh_paths": paths,
        "search": search,
        "draw": draw,
        "offsets": _OFFSETS.index(offsets),
        "reader": _READERS.index(reader),
    }
    arrays = samples._arrays
    if arrays is not None and text is not None and not search and len(samples) > _MANY:
        calibrated = _kinecal.calibrate_arrays(
            robot.urdf, robot.file, arrays, text, name, dict(options), progress, _ROWS
        )
    else:
        calibrated = _kinecal.calibrate(
            robot.urdf, robot.file, samples._samples, text, name, dict(options), progress
        )
    return Result(calibrated, paths)
