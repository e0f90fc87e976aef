# SPDX-License-Identifier: Apache-2.0
"""The matcher of disparityd for programs that have images: no daemon, numpy in and out.

    import disparity_matcher as disparity

    result = disparity.match(left, right, preset="dense", disparities=64)
    print(result.disparity_px, result.confidence)

Where the client is installed, too, its package `disparity` has the same names. docs/python.md shows how to use them.
"""
from .calibration import Calibration, Rectifier, load_calibration
from .matching import Match, Matcher, match
from .sgbm import StereoSGM, StereoSGM_create
from .sources import Frame as SourceFrame
from .sources import Source, open  # noqa: A004

__all__ = ["Calibration", "Match", "Matcher", "Rectifier", "Source", "SourceFrame", "StereoSGM", "StereoSGM_create",
           "load_calibration", "match", "open"]
