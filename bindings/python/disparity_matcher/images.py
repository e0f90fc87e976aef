# SPDX-License-Identifier: Apache-2.0
"""Takes numpy arrays of users as images, or says in one line why it cannot."""
from __future__ import annotations

import operator
import typing

import numpy as np

# ImageLike is what users may give: anything that numpy makes an array of.
if typing.TYPE_CHECKING:
    import numpy.typing as npt

    ImageLike = npt.ArrayLike
    Image = npt.NDArray[np.uint8]
    Matrix = npt.NDArray[np.float64]
else:  # the numpy of Debian 11 has no types
    ImageLike = Image = Matrix = np.ndarray

_LARGEST_SIDE = 8192


def whole_number(name: str, value: typing.Any, least: int, most: int) -> int:
    """Returns the number. ValueError with one line where it is none from `least` to `most`."""
    try:
        number = operator.index(value)
    except TypeError:
        number = least - 1
    if not least <= number <= most:
        raise ValueError(f"{name}: found '{value}', allowed: a whole number from {least} to {most}")
    return number


def size_text(image: npt.NDArray[typing.Any]) -> str:
    """Returns width x height as messages have them."""
    return f"{image.shape[1]}x{image.shape[0]}"


def eight_bits(image: npt.NDArray[np.uint16], bits: int) -> Image:
    """Returns value / 2^(bits - 8), at most 255, as of image files of 16 bits per channel."""
    return np.minimum(image >> (bits - 8), 255).astype(np.uint8)


def as_image(name: str, given: ImageLike, bits: int | None) -> Image:
    """Returns uint8 of height x width, or x 3 (BGR), in whose rows pixels follow each other without gaps. It is the array
    that was given where that is such an array, also a part of one; else a copy.

    bits: how many of uint16 count, which have to say it. ValueError with one line for what is no image.
    """
    if isinstance(given, np.ma.MaskedArray):
        raise ValueError(f"{name}: found a masked array, whose mask would be lost: give its data, or filled()")
    image = np.asarray(given)
    if image.dtype.kind != "u" or image.dtype.itemsize > 2:
        raise ValueError(f"{name}: found an array of {image.dtype}, allowed: uint8, or uint16 with its number of bits")
    if image.ndim == 3 and image.shape[2] == 1:
        image = image[:, :, 0]
    if image.ndim != 2 and (image.ndim != 3 or image.shape[2] != 3):
        raise ValueError(f"{name}: found an array of shape {image.shape}, allowed: (height, width) for grey, "
                         "(height, width, 3) for BGR")
    if not all(1 <= side <= _LARGEST_SIDE for side in image.shape[:2]):
        raise ValueError(f"{name}: image size {size_text(image)}: allowed is 1 to {_LARGEST_SIDE} each")
    if image.dtype.itemsize == 2:
        if bits is None:
            raise ValueError(f"{name}: found an array of uint16: say with bits=9 to 16 how many bits the values have, such as 10 of "
                             "a camera with 10 bits")
        return eight_bits(image, bits)
    channels = image.shape[2] if image.ndim == 3 else 1
    without_gaps = image.strides[1:] == ((channels, 1) if image.ndim == 3 else (1,))
    if without_gaps and image.strides[0] >= image.shape[1] * channels:
        return image
    return image.copy()  # not ascontiguousarray(), which returns a single row with any stride as it is


def as_pair(left: ImageLike, right: ImageLike, bits: int | None) -> tuple[Image, Image]:
    """Returns both images of a pair. ValueError with one line where they are no images of one size and kind."""
    if bits is not None:
        bits = whole_number("bits", bits, 9, 16)
    pair = as_image("left", left, bits), as_image("right", right, bits)
    if pair[0].shape != pair[1].shape:
        kinds = ["BGR" if image.ndim == 3 else "grey" for image in pair]
        raise ValueError(f"left is {size_text(pair[0])} {kinds[0]}, right {size_text(pair[1])} {kinds[1]}: the images of a pair "
                         "must be alike")
    return pair
