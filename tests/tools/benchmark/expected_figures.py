# SPDX-License-Identifier: Apache-2.0
"""The figures of `disparity-eval --benchmark`, computed by numpy alone from arrays: nothing of the program is used."""
import numpy

LIMITS = {"bad_05": 0.5, "bad_1": 1, "bad_2": 2, "bad_3": 3, "bad_4": 4}
QUANTILES = {"a50_px": 50, "a90_px": 90, "a95_px": 95, "a99_px": 99}
FIGURES = ["density", *LIMITS, "d1", "avg_px", "rms_px", *QUANTILES, "ause_px", "ause_relative"]
V3_HALF = {"PianoL", "Playroom", "Playtable", "Shelves", "Vintage"}


def windows(array, reach):
    """Arrays shifted by each step of a window, NaN outside."""
    padded = numpy.pad(array.astype(float), reach, constant_values=numpy.nan)
    height, width = array.shape
    return numpy.stack([padded[y:y + height, x:x + width] for y in range(2 * reach + 1) for x in range(2 * reach + 1)])


def near_edges(truth):
    steps = numpy.zeros(truth.shape)
    across = numpy.abs(numpy.diff(truth, axis=1)) >= 2
    down = numpy.abs(numpy.diff(truth, axis=0)) >= 2
    steps[:, :-1][across] = 1
    steps[:, 1:][across] = 1
    steps[:-1][down] = 1
    steps[1:][down] = 1
    return numpy.nansum(windows(steps, 4), axis=0) > 0


def weak_texture(grey):
    squares = numpy.diff(grey.astype(float), axis=1) ** 2
    larger = numpy.maximum(numpy.pad(squares, ((0, 0), (1, 0))), numpy.pad(squares, ((0, 0), (0, 1))))
    return numpy.nanmean(windows(larger, 1), axis=0) < 16


def regions(scene):
    known = ~numpy.isnan(scene.truth)
    seen = known if scene.visible is None else known & scene.visible
    found = {"all": known}
    if scene.visible is not None:
        found["nonocc"] = seen
    found["edges"] = seen & near_edges(scene.truth)
    found["weak-texture"] = seen & weak_texture(scene.left)
    if scene.foreground is not None:
        found.update({"bg": known & ~scene.foreground, "fg": known & scene.foreground})
        if scene.visible is not None:
            found.update({"bg-nonocc": seen & ~scene.foreground, "fg-nonocc": seen & scene.foreground})
    return found


def filled(disparity):
    """KITTI's filling, pixel by pixel."""
    result = disparity.copy()
    for row in result:
        known = numpy.flatnonzero(~numpy.isnan(row))
        for x in range(len(row) if len(known) else 0):
            before, behind = known[known <= x], known[known >= x]
            row[x] = min([row[side] for side in (before[-1:], behind[:1]) if len(side)], key=float)[0]
    full = numpy.flatnonzero(~numpy.isnan(result).all(axis=1))
    if len(full):
        result[:full[0]] = result[full[0]]
        result[full[-1] + 1:] = result[full[-1]]
    return result


def curve(order, errors):
    """Mean error left after each percent was removed; `order` are keys, pixels of the smallest go first."""
    keys, group = numpy.unique(order, return_inverse=True)
    pixels = numpy.concatenate([[0], numpy.cumsum(numpy.bincount(group, minlength=len(keys)))])
    removed = numpy.concatenate([[0], numpy.cumsum(numpy.bincount(group, errors, len(keys)))])
    at = len(errors) * numpy.arange(100) / 100
    return (errors.sum() - numpy.interp(at, pixels, removed)) / (len(errors) - at)


class Tally:
    def __init__(self, region, truth, disparity, confidence, holes):
        judged = filled(disparity) if holes == "filled" else disparity
        self.pixels = int(region.sum())
        self.measured = int((region & ~numpy.isnan(disparity)).sum())
        has = region & ~numpy.isnan(judged)
        self.errors = numpy.abs(judged[has].astype(float) - truth[has].astype(float))
        outliers = (self.errors > 3) & (self.errors * 20 > numpy.abs(truth[has].astype(float)))
        lost = 0 if holes == "left-out" else self.pixels - len(self.errors)
        self.judged = len(self.errors) + lost
        self.bad = {name: int((self.errors > limit).sum()) + lost for name, limit in LIMITS.items()}
        self.bad["d1"] = int(outliers.sum()) + lost
        self.sum, self.squares, self.count = self.errors.sum(), (self.errors ** 2).sum(), len(self.errors)
        self.curves = None
        if confidence is not None and self.count:
            self.curves = curve(confidence[has], self.errors), curve(-self.errors, self.errors)

    def figures(self, of_one_scene=True):
        def share(part, whole):
            return 100 * part / whole if whole else None

        values = {"density": share(self.measured, self.pixels), **{name: share(count, self.judged) for name, count in self.bad.items()},
                  "avg_px": self.sum / self.count if self.count else None,
                  "rms_px": (self.squares / self.count) ** 0.5 if self.count else None}
        for name, percent in QUANTILES.items():
            known = of_one_scene and self.count
            values[name] = sorted(self.errors)[-(-self.count * percent // 100) - 1] if known else None
        area = (self.curves[0] - self.curves[1]).mean() if of_one_scene and self.curves else None
        values["ause_px"] = area
        values["ause_relative"] = None if area is None else area / self.curves[0][0] if self.curves[0][0] > 0 else 0.0
        return [values[name] for name in FIGURES]


def added(tallies):
    total = object.__new__(Tally)
    for name in ("pixels", "measured", "judged", "sum", "squares", "count"):
        setattr(total, name, sum(getattr(one, name) for one in tallies))
    total.bad = {name: sum(one.bad[name] for one in tallies) for name in tallies[0].bad}
    total.errors, total.curves = None, None
    return total


def mean(rows, weights):
    means = []
    for values in zip(*rows):
        known = [(value, weight) for value, weight in zip(values, weights) if value is not None]
        means.append(sum(value * weight for value, weight in known) / sum(weight for _, weight in known) if known else None)
    return means
