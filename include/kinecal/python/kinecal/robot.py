"""Robots and their kinematics."""

from __future__ import annotations

import html
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _kinecal
from .errors import KinecalError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .arrays import Array



@dataclass(frozen=True)
class Joint:
    """A joint of a URDF."""

    name: str
    type: str  #: "revolute", "continuous", "prismatic", "fixed", "floating" or "planar"
    parent: str  #: link
    child: str  #: link
    axis: tuple[float, float, float]  #: unit vector, in the joint's frame
    mimic: str | None  #: the joint that it follows
    limits: tuple[float, float] | None  #: radians or metres


class Robot:
    """A robot as its URDF describes it.

    Args:
        urdf: file, or the text of a URDF.

    Raises:
        KinecalError: if it is no URDF, with file and line.
    """

    def __init__(self, urdf: str | os.PathLike[str]) -> None:
        if not isinstance(urdf, (str, os.PathLike)):
            raise KinecalError(f"a robot is a file or the text of a URDF, not {type(urdf).__name__}")
        text, name = str(os.fspath(urdf)), "robot.urdf"
        self._path: str | None = None  #: of its file
        if "<" not in text:
            self._path = text
            text, name = _kinecal.read_urdf_text(text), text
        self._robot = _kinecal.Robot(text, name)
        self._joints = [Joint(**joint) for joint in self._robot.joints]

    @property
    def name(self) -> str:
        """Name in the URDF."""
        return self._robot.name

    @property
    def urdf(self) -> str:
        """Text of the URDF."""
        return self._robot.text

    @property
    def file(self) -> str:
        """File of the URDF; "robot.urdf" for a text."""
        return self._robot.file

    @property
    def joints(self) -> list[Joint]:
        """All joints, in the order of the URDF."""
        return list(self._joints)

    @property
    def joint_names(self) -> list[str]:
        """Joints with positions of their own, in the order of the URDF: the columns of ``q``."""
        moving = ("revolute", "continuous", "prismatic")
        return [joint.name for joint in self._joints if joint.type in moving and not joint.mimic]

    @property
    def links(self) -> list[str]:
        """All links, sorted."""
        return self._robot.links

    @property
    def root(self) -> str:
        """The link that is no joint's child."""
        children = {joint.child for joint in self._joints}
        return next((link for link in self.links if link not in children), "")

    @property
    def limits(self) -> Array:
        """(joints, 2) lower and upper limit of :attr:`joint_names`, radians or metres; infinite without one."""
        import numpy as np

        by_name = {joint.name: joint.limits for joint in self._joints}
        no_limits = (-np.inf, np.inf)
        pairs = [by_name[name] or no_limits for name in self.joint_names]
        return np.array(pairs, dtype=np.float64).reshape(-1, 2)

    def chain(self, tip: str, base: str | None = None) -> list[str]:
        """Joints between two links that move, from base to tip.

        Args:
            base: link; None: the root.
        """
        return self._robot.chain(base or self.root, tip, []).joints

    def forward_kinematics(
        self,
        q: ArrayLike | Mapping[str, ArrayLike],
        frame: str,
        *,
        base: str | None = None,
        joints: Sequence[str] | None = None,
    ) -> Array:
        """Poses of a link.

        Args:
            q: (n, joints) or (joints) positions, radians or metres; or arrays (n) by name, where joints that are missing
                stay at zero.
            frame: link whose pose is computed.
            base: link in which it is given; None: the root.
            joints: names of the columns of ``q``; None: :attr:`joint_names`.

        Returns:
            (n, 4, 4) or (4, 4) base_T_frame, metres.
        """
        return self._kinematics(q, frame, base, joints, False)[0]

    def jacobian(
        self,
        q: ArrayLike | Mapping[str, ArrayLike],
        frame: str,
        *,
        base: str | None = None,
        joints: Sequence[str] | None = None,
    ) -> Array:
        """Geometric Jacobians of a link; the arguments are those of :meth:`forward_kinematics`.

        Returns:
            (n, 6, joints) or (6, joints): linear velocity of the frame's origin, then angular velocity, both in the
            base, for that of each column of ``q``.
        """
        return self._kinematics(q, frame, base, joints, True)[1]

    def _kinematics(
        self,
        q: ArrayLike | Mapping[str, ArrayLike],
        frame: str,
        base: str | None,
        joints: Sequence[str] | None,
        jacobians: bool,
    ) -> tuple[Array, Array]:
        import numpy as np

        from .arrays import names as checked
        from .arrays import numbers

        if isinstance(q, Mapping):
            if joints is not None:
                raise KinecalError("joints: q has names already")
            joints = list(q)
            arrays = [numbers(q[name], f"q['{name}']") for name in q]
            try:
                columns = np.broadcast_arrays(*arrays)
            except ValueError:
                raise KinecalError("q: arrays of different lengths") from None
            q = np.stack(columns, axis=-1) if columns else np.zeros((1, 0))
        names = self.joint_names if joints is None else checked(joints, "joints")
        self._check_names(names)
        array = numbers(q, "q")
        if array.ndim not in (1, 2) or array.shape[-1] != len(names):
            raise KinecalError(
                f"q: has shape {array.shape}; (n, {len(names)}) or ({len(names)},) is expected: "
                + ", ".join(names)
            )
        rows = array.reshape(-1 if names else len(np.atleast_2d(array)), len(names))
        chain = self._robot.chain(base or self.root, frame, names)
        poses, derivatives = chain.kinematics(rows, jacobians)
        if array.ndim == 1:
            return poses[0], derivatives[0] if jacobians else derivatives
        return poses, derivatives

    def _check_names(self, names: Sequence[str]) -> None:
        known = {joint.name: joint for joint in self._joints}
        for name in names:
            if name not in known:
                raise KinecalError(f"'{name}' is no joint of {self.name}{_nearest(name, known)}")
            if known[name].mimic:
                raise KinecalError(f"'{name}' follows '{known[name].mimic}': give that one")

    def __reduce__(self) -> tuple[Any, ...]:
        return _robot_from, (self.urdf, self.file)

    def __repr__(self) -> str:
        return f"<Robot '{self.name}': {len(self.joint_names)} joints, {len(self.links)} links>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(joint.name)}</td><td>{joint.type}</td>"
            f"<td>{html.escape(joint.parent)}</td><td>{html.escape(joint.child)}</td></tr>"
            for joint in self._joints
            if joint.type != "fixed"
        )
        return (
            f"<b>{html.escape(self.name)}</b>: {len(self.joint_names)} joints, {len(self.links)} links"
            f"<table><tr><th>joint</th><th>type</th><th>parent</th><th>child</th></tr>{rows}</table>"
        )


def _robot_from(text: str, name: str) -> Robot:
    robot = Robot(text)
    robot._robot = _kinecal.Robot(text, name)
    return robot


def _nearest(name: str, known: Mapping[str, object]) -> str:
    import difflib

    near = difflib.get_close_matches(name, known, 1)
    return f"; did you mean '{near[0]}'?" if near else ""
