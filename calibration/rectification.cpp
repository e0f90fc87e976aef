// SPDX-License-Identifier: Apache-2.0
#include "calibration/rectification.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/message_text.h"
#include "calibration/calibration.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/lens.h"
#include "calibration/rectified_camera.h"

namespace disparityd::calibration {
namespace {

constexpr double smallest_factor = 0.25;
constexpr double smallest_share = 0.25;
constexpr int steps = 24;  // of the grid that is laid over the rectified image, each way

std::string short_text(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", number);
    return text;
}

/// Returns the place in the raw image of a place in the rectified one.
ImagePoint raw_pixel(const Lens& lens, const std::array<double, 9>& turn, double x, double y) {
    return lens.pixel_of(turn[0] * x + turn[3] * y + turn[6], turn[1] * x + turn[4] * y + turn[7],
                         turn[2] * x + turn[5] * y + turn[8]);
}

/// Returns where the grid's points lie in the raw image; not numbers behind the camera.
std::vector<ImagePoint> grid_in_raw_image(const StereoCalibration& calibration, const CameraModel& camera,
                                          const RectifiedCamera& view, const std::array<double, 9>& turn) {
    const Lens lens(camera);
    std::vector<ImagePoint> points;
    for (int y = 0; y <= steps; ++y) {
        for (int x = 0; x <= steps; ++x) {
            points.push_back(raw_pixel(lens, turn, (calibration.width * x / double{steps} - view.cx) / view.f,
                                       (calibration.height * y / double{steps} - view.cy) / view.f));
        }
    }
    return points;
}

/// The area of the grid in the raw image; negative when a cell of it is turned over.
double area_of(const std::vector<ImagePoint>& points) {
    double sum = 0;
    for (int y = 0; y < steps; ++y) {
        for (int x = 0; x < steps; ++x) {
            const auto at = [&](int right, int down) {
                return points[static_cast<std::size_t>((y + down) * (steps + 1) + x + right)];
            };
            const ImagePoint a = at(0, 0), b = at(1, 1), c = at(1, 0), d = at(0, 1);
            const double area = 0.5 * ((b.x - a.x) * (d.y - c.y) - (b.y - a.y) * (d.x - c.x));
            if (!(area > 0)) {
                return -1;
            }
            sum += area;
        }
    }
    return sum;
}

/// Checks that two raw eyes can be rectified to a camera that is like them: its focal length is within a quarter and
/// four times theirs, it shows at least a quarter of each eye's image, and the lenses do not fold what it shows.
/// Numbers may each be possible and together be those of no camera. Throws std::invalid_argument with one line.
void check_rectified_view(const StereoCalibration& calibration) {
    const RectifiedCamera view = rectified_camera(calibration, calibration.width, calibration.height);
    const std::string advice =
        ": these numbers are not those of a stereo camera with images of this size; compare the size that the "
        "calibration was made for, "
        "or calibrate again";
    for (const CameraModel* camera : {&calibration.left, &calibration.right}) {
        const double factor = view.f / camera->fx;
        if (!(factor >= smallest_factor && factor <= 1 / smallest_factor)) {
            refuse_calibration(calibration.origin, "cannot be rectified: the focal length becomes " +
                                                       short_text(view.f) + " px, that of the eyes is " +
                                                       short_text(camera->fx) +
                                                       " px, allowed is a quarter to four times of it" + advice);
        }
    }
    for (const int eye : {0, 1}) {
        const CameraModel& camera = eye == 0 ? calibration.left : calibration.right;
        const auto points = grid_in_raw_image(calibration, camera, view, view.turn[eye]);
        const double area = area_of(points);
        const double share = area / (static_cast<double>(calibration.width) * calibration.height);
        const std::string name = eye == 0 ? "left" : "right";
        if (area < 0) {
            refuse_calibration(calibration.origin,
                               "cannot be rectified: the distortion folds the image of the " + name + " eye" + advice);
        }
        if (!(share >= smallest_share)) {
            refuse_calibration(calibration.origin, "cannot be rectified: the rectified image shows " +
                                                       short_text(100 * share) + " % of that of the " + name +
                                                       " eye, allowed is at least 25 %" + advice);
        }
    }
}

constexpr int largest_side = 8192;

RectifiedGeometry complete(RectifiedGeometry geometry, int eye_width, int height) {
    if (geometry.width == 0 && geometry.height == 0) {
        geometry.width = eye_width;
        geometry.height = height;
    }
    if (geometry.width < 1 || geometry.width > largest_side || geometry.height < 1 || geometry.height > largest_side) {
        throw std::invalid_argument("rectified size: found " + base::size_text(geometry.width, geometry.height) +
                                    ", allowed is 1x1 to 8192x8192, or 0x0 for the capture size");
    }
    RectifiedGeometry::Region& region = geometry.region;
    if (region.width == 0 && region.height == 0 && region.x == 0 && region.y == 0) {
        region.width = geometry.width;
        region.height = geometry.height;
    }
    if (region.x < 0 || region.y < 0 || region.width < 1 || region.height < 1 ||
        region.width > geometry.width - region.x || region.height > geometry.height - region.y) {
        throw std::invalid_argument("rectified region: found " + base::size_text(region.width, region.height) +
                                    " at (" + std::to_string(region.x) + ", " + std::to_string(region.y) +
                                    "), it must lie within the rectified image of " +
                                    base::size_text(geometry.width, geometry.height));
    }
    return geometry;
}

/// Returns a place in 1/32 px, rounded to the nearest, to the even one between two. Places that the map's 16 bits
/// cannot hold lie outside the image wherever they are.
int fixed_point(double place) {
    constexpr double least = -32768.0 * 32, most = 32767.0 * 32;
    const double scaled = place * 32;
    return scaled >= least ? static_cast<int>(std::lrint(std::min(scaled, most))) : static_cast<int>(least);
}

/// Makes the map of one eye. `rectified` is the camera of the whole rectified image, which has no distortion.
Rectification::Maps make_maps(const CameraModel& camera, const std::array<double, 9>& turn,
                              const CameraModel& rectified, const RectifiedGeometry::Region& region) {
    const Lens lens(camera);
    const std::size_t pixels = static_cast<std::size_t>(region.width) * static_cast<std::size_t>(region.height);
    Rectification::Maps maps;
    maps.xy.reserve(2 * pixels);
    maps.fraction.reserve(pixels);
    for (int y = region.y; y < region.y + region.height; ++y) {
        for (int x = region.x; x < region.x + region.width; ++x) {
            const ImagePoint raw =
                raw_pixel(lens, turn, (x - rectified.cx) / rectified.fx, (y - rectified.cy) / rectified.fy);
            const int column = fixed_point(raw.x);
            const int row = fixed_point(raw.y);
            maps.xy.push_back(static_cast<std::int16_t>(column >> 5));
            maps.xy.push_back(static_cast<std::int16_t>(row >> 5));
            maps.fraction.push_back(static_cast<std::uint16_t>((row & 31) * 32 + (column & 31)));
        }
    }
    return maps;
}

void use_projection(Rectification& result, double f, double cx, double cy, const RectifiedGeometry& geometry) {
    result.f = f;
    result.cx = cx - geometry.region.x;
    result.cy = cy - geometry.region.y;
}

// Rectifies two raw eyes to one camera.
void rectify_raw(Rectification& result, const StereoCalibration& calibration, const RectifiedGeometry& geometry) {
    const RectifiedCamera view = rectified_camera(calibration, geometry.width, geometry.height);
    if (!std::isfinite(view.f) || view.f <= 0 || !std::isfinite(view.baseline_mm) || view.baseline_mm <= 0) {
        throw std::invalid_argument("calibration " + calibration.origin +
                                    ": cannot be rectified: the cameras do not look side by side the same way");
    }
    check_rectified_view(calibration);
    use_projection(result, view.f, view.cx, view.cy, geometry);
    result.baseline_mm = view.baseline_mm;
    result.left_rotation = view.turn[0];
    result.right_rotation = view.turn[1];
    const CameraModel rectified{view.f, view.f, view.cx, view.cy, {}};
    result.left = make_maps(calibration.left, view.turn[0], rectified, geometry.region);
    result.right = make_maps(calibration.right, view.turn[1], rectified, geometry.region);
}

// Takes eyes as they are, or scales them. Without a focal length only the scale is known.
void scale_rectified(Rectification& result, const StereoCalibration& calibration, const RectifiedGeometry& geometry) {
    const double scale_x = static_cast<double>(geometry.width) / calibration.width;
    const double scale_y = static_cast<double>(geometry.height) / calibration.height;
    const bool metric = calibration.left.fx != 0;
    const auto scaled = [&](const CameraModel& camera) {
        return CameraModel{camera.fx * scale_x,
                           camera.fy * scale_y,
                           (camera.cx + 0.5) * scale_x - 0.5,
                           (camera.cy + 0.5) * scale_y - 0.5,
                           {}};
    };
    if (metric) {
        const CameraModel camera = scaled(calibration.left);
        use_projection(result, camera.fx, camera.cx, camera.cy, geometry);
        result.baseline_mm = -calibration.translation[0];
        result.disparity_offset = (calibration.right.cx - calibration.left.cx) * scale_x;
    }
    if (geometry.width == calibration.width && geometry.height == calibration.height) {
        result.crop_x = geometry.region.x;
        result.crop_y = geometry.region.y;
        return;
    }
    // Both eyes use the same map: a pixel keeps its place in the image, whatever the principal points.
    const CameraModel plain{1, 1, 0, 0, {}};
    result.left = make_maps(plain, {1, 0, 0, 0, 1, 0, 0, 0, 1}, scaled(plain), geometry.region);
    result.right = result.left;
}

// FNV-1a: short, and the same on every machine.
class Fingerprint {
public:
    template <typename T>
    void add(const std::vector<T>& values) {
        for (const T value : values) {
            add(static_cast<std::uint64_t>(static_cast<std::make_unsigned_t<T>>(value)));
        }
    }
    void add(double value) { add(static_cast<std::uint64_t>(std::llround(value * 1e6))); }
    void add(int value) { add(static_cast<std::uint64_t>(value)); }
    std::uint64_t value() const { return hash_; }

private:
    void add(std::uint64_t value) { hash_ = (hash_ ^ value) * 0x100000001b3ULL; }
    std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

std::uint64_t fingerprint(const Rectification& rectification) {
    Fingerprint hash;
    hash.add(rectification.width);
    hash.add(rectification.height);
    hash.add(rectification.crop_x);
    hash.add(rectification.crop_y);
    for (const double value : {rectification.f, rectification.cx, rectification.cy, rectification.baseline_mm,
                               rectification.disparity_offset}) {
        hash.add(value);
    }
    for (const Rectification::Maps* maps : {&rectification.left, &rectification.right}) {
        hash.add(maps->xy);
        hash.add(maps->fraction);
    }
    return hash.value();
}

}  // namespace

Rectification make_rectification(const std::optional<StereoCalibration>& calibration, int eye_width, int height,
                                 const RectifiedGeometry& wanted) {
    if (calibration && (calibration->width != eye_width || calibration->height != height)) {
        refuse_other_size(calibration->origin, base::size_text(calibration->width, calibration->height), eye_width,
                          height);
    }
    const RectifiedGeometry geometry = complete(wanted, eye_width, height);
    Rectification result;
    result.width = geometry.region.width;
    result.height = geometry.region.height;
    result.unrectified = !calibration;
    if (calibration && !calibration->rectified) {
        rectify_raw(result, *calibration, geometry);
    } else {
        StereoCalibration plain;
        plain.width = eye_width;
        plain.height = height;
        scale_rectified(result, calibration.value_or(plain), geometry);
    }
    result.calibration_id = fingerprint(result);
    return result;
}

Rectifier Rectification::rectifier() const {
    Rectifier rectifier;
    rectifier.mapped = !left.xy.empty();
    rectifier.crop_x = crop_x;
    rectifier.crop_y = crop_y;
    rectifier.id = calibration_id;
    const auto view = [this](const Maps& maps) {
        return RectifyMap{{maps.xy.data(), 2 * width, height, 2 * width}, {maps.fraction.data(), width, height, width}};
    };
    if (rectifier.mapped) {
        rectifier.left = view(left);
        rectifier.right = view(right);
    }
    return rectifier;
}

DepthScale Rectification::depth_scale() const {
    return {std::llround(16.0 * f * baseline_mm), static_cast<int>(std::lround(16.0 * disparity_offset))};
}

}  // namespace disparityd::calibration
