# SPDX-License-Identifier: Apache-2.0
"""Prints the Python client's table of products in the form that products_test.cpp compares: number, name, bytes.

Exit status 77: a Python module is missing, said on stderr.
"""
import sys

try:
    import google.protobuf  # noqa: F401
    import numpy as np
except ImportError as error:
    print(f"skipped: {error}", file=sys.stderr)
    sys.exit(77)

import disparity

for number, product in disparity.frame.PRODUCTS.items():
    assert getattr(disparity, product.name.upper()) == number, product
    bytes_per_pixel = np.dtype(product.kind).itemsize * product.channels
    frame = disparity.Frame()
    try:
        getattr(frame, product.name)
    except KeyError as error:
        assert product.name in str(error), error
    else:
        raise AssertionError(f"an empty frame has {product.name}")
    size = max(bytes_per_pixel, 1)
    plane = disparity.frame.plane_array(number, 2, 1, size, bytes(2 * size))
    frame.planes[number] = plane
    assert plane.shape[:2] == (1, 2)
    if product.channels > 0:  # a record is read, not shown
        assert getattr(frame, product.name) is plane
    print(number, product.name, bytes_per_pixel)
