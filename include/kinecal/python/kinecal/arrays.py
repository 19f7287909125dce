"""Arrays at the border: every one is checked before it goes into the library."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import KinecalError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]
    Integers = NDArray[np.intp]


def numbers(values: ArrayLike, name: str) -> Array:
    """An array of float64, row by row, without a copy where it is one already; what is masked is NaN.

    Raises:
        KinecalError: if it has no numbers: texts, objects, complex numbers, rows of different lengths.
    """
    try:
        array: NDArray[Any] = np.asarray(values)
    except (TypeError, ValueError) as error:
        raise KinecalError(f"{name}: rows of different lengths ({error})") from None
    if array.dtype.kind not in "fiu" and array.size > 0:
        raise KinecalError(f"{name}: {array.dtype} are no real numbers")
    if isinstance(values, np.ma.MaskedArray):
        return np.where(np.ma.getmaskarray(values), np.nan, array.astype(np.float64))  # type: ignore[no-untyped-call]
    return np.ascontiguousarray(array, dtype=np.float64)


def shaped(values: ArrayLike, name: str, shape: tuple[int | str, ...]) -> Array:
    """Numbers of a shape, in which texts stand for any size: ("n", "k", 3)."""
    array = numbers(values, name)
    fits = array.ndim == len(shape) and all(
        isinstance(want, str) or want == is_ for want, is_ in zip(shape, array.shape)
    )
    if not fits:
        wanted = ", ".join(str(size) for size in shape)
        raise KinecalError(f"{name}: has shape {array.shape}; ({wanted}) is expected")
    return array


def finite(array: Array, name: str, columns: list[str]) -> Array:
    """Refuses NaN and infinity, by row and name of the column."""
    bad = np.argwhere(~np.isfinite(array))
    if bad.size > 0:
        row, column = (int(i) for i in bad[0])
        raise KinecalError(
            f"{name}:{row + 1}: '{columns[column]}' is {array[row, column]}; remove the row"
        )
    return array


def names(values: object, what: str) -> list[str]:
    """A list of different names.

    Raises:
        KinecalError: for one text in the place of a list, what is no text, an empty name, or the same one twice.
    """
    if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
        raise KinecalError(f"{what}: {values!r} is no list of names")
    listed = list(values)
    for name in listed:
        if not isinstance(name, str) or not name.isprintable() or not name.strip():
            raise KinecalError(f"{what}: {name!r} is no name")
        if listed.count(name) > 1:
            raise KinecalError(f"{what}: '{name}' is given twice")
    return listed


def by_name(values: object, what: str) -> Mapping[str, Any]:
    """A dict by names; None: an empty one."""
    if values is None:
        return {}
    if not isinstance(values, Mapping):
        raise KinecalError(f"{what}: a dict by names is expected, not {type(values).__name__}")
    names(values, what)
    return values
