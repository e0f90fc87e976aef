# SPDX-License-Identifier: Apache-2.0
"""Matches a pair that is 9 px apart, by the names that the client's package has of the matcher."""
import disparity
import numpy

dots = numpy.random.default_rng(1).integers(0, 256, (120, 329), numpy.uint8)
found = disparity.match(dots[:, :320], dots[:, 9:], preset="paper", disparities=32)
print(f"{numpy.nanmedian(found.disparity_px[:, 40:]):.2f} px")
