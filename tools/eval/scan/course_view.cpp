// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tools/eval/scan/course.h"

namespace disparityd::eval {
namespace {

constexpr std::int16_t ground_index = -1;
constexpr std::int16_t wall_index = -2;
constexpr std::int16_t nothing_index = -3;
/// Rays per pixel and side: edges of thin objects are grey, as a camera's are.
constexpr int rays = 2;

struct Hit {
    double distance = std::numeric_limits<double>::infinity();
    std::int16_t object = nothing_index;
};

std::uint32_t hash(std::int64_t x, std::int64_t y, std::int64_t z, std::uint32_t seed) {
    std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9e3779b97f4a7c15ULL ^
                      static_cast<std::uint64_t>(y) * 0xc2b2ae3d27d4eb4fULL ^
                      static_cast<std::uint64_t>(z) * 0x165667b19e3779f9ULL ^ seed;
    h = (h ^ (h >> 29)) * 0xbf58476d1ce4e5b9ULL;
    return static_cast<std::uint32_t>(h >> 32);
}

/// Smooth noise of one grain size, -1 .. 1.
double noise(Point p, double grain, std::uint32_t seed) {
    const std::array<double, 3> at{p.x / grain, p.y / grain, p.z / grain};
    std::array<std::int64_t, 3> cell{};
    std::array<double, 3> part{};
    for (std::size_t i = 0; i < 3; ++i) {
        cell[i] = static_cast<std::int64_t>(std::floor(at[i]));
        const double t = at[i] - static_cast<double>(cell[i]);
        part[i] = t * t * (3 - 2 * t);
    }
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1;
        const int dy = (corner >> 1) & 1;
        const int dz = corner >> 2;
        const double weight =
            (dx != 0 ? part[0] : 1 - part[0]) * (dy != 0 ? part[1] : 1 - part[1]) * (dz != 0 ? part[2] : 1 - part[2]);
        sum += weight * (hash(cell[0] + dx, cell[1] + dy, cell[2] + dz, seed) / 2147483648.0 - 1);
    }
    return sum;
}

/// The luma of a surface at a point. Structure that is finer than `pixel_m` is left out, as a lens does.
double luma(const Surface& surface, Point p, double pixel_m, std::uint32_t seed) {
    double value = 0;
    if (surface.kind == Surface::Kind::striped) {
        value = std::sin(2 * std::numbers::pi * (p.y + 0.37 * p.x) / surface.grain_m);
    } else if (surface.kind == Surface::Kind::rough) {
        double weight = 0.6;
        for (double grain = surface.grain_m * 4; grain > std::max(pixel_m, 0.002); grain /= 2, weight *= 0.8) {
            value += weight * noise(p, grain, seed);
        }
    }
    return surface.luma + surface.contrast * value;
}

void meet_box(Point o, Point d, const Obstacle& box, std::int16_t index, Hit& hit) {
    double near = 0;
    double far = hit.distance;
    const std::array<std::array<double, 4>, 3> axes{{{o.x, d.x, box.centre.x, box.half.x},
                                                     {o.y, d.y, box.centre.y, box.half.y},
                                                     {o.z, d.z, box.centre.z, box.half.z}}};
    for (const auto& [from, step, middle, half] : axes) {
        const double a = (middle - half - from) / step;
        const double b = (middle + half - from) / step;
        near = std::max(near, std::min(a, b));
        far = std::min(far, std::max(a, b));
    }
    if (near < far && near > 0) {
        hit = {near, index};
    }
}

/// Returns where a ray first meets a cylinder of endless length; infinite where it passes by. (x, y) is across the
/// axis: the ray's origin from there, and its direction.
double to_cylinder(double x, double y, double dx, double dy, double radius) {
    const double a = dx * dx + dy * dy;
    const double b = x * dx + y * dy;
    const double root = b * b - a * (x * x + y * y - radius * radius);
    return root < 0 ? std::numeric_limits<double>::infinity() : (-b - std::sqrt(root)) / a;
}

void meet_post(Point o, Point d, const Obstacle& post, std::int16_t index, Hit& hit) {
    const double t = to_cylinder(o.x - post.centre.x, o.y - post.centre.y, d.x, d.y, post.half.x);
    if (t > 0 && t < hit.distance && std::abs(o.z + t * d.z - post.centre.z) <= post.half.z) {
        hit = {t, index};
    }
}

void meet_wire(Point o, Point d, const Obstacle& wire, std::int16_t index, Hit& hit) {
    const double t = to_cylinder(o.x - wire.centre.x, o.z - wire.centre.z, d.x, d.z, wire.half.x);
    if (t > 0 && t < hit.distance && std::abs(o.y + t * d.y - wire.centre.y) <= wire.half.y) {
        hit = {t, index};
    }
}

Hit cast(const Course& course, Point o, Point d) {
    Hit hit;
    if (d.x > 0) {
        hit = {(course.wall_m - o.x) / d.x, wall_index};
    }
    const double fall = d.z - course.slope_ahead * d.x - course.slope_left * d.y;
    const double above = o.z - course.slope_ahead * o.x - course.slope_left * o.y;
    if (fall < 0 && -above / fall < hit.distance) {
        hit = {-above / fall, ground_index};
    }
    for (std::size_t i = 0; i < course.obstacles.size(); ++i) {
        const Obstacle& obstacle = course.obstacles[i];
        const auto index = static_cast<std::int16_t>(i);
        switch (obstacle.shape) {
            case Obstacle::Shape::box: meet_box(o, d, obstacle, index, hit); break;
            case Obstacle::Shape::post: meet_post(o, d, obstacle, index, hit); break;
            case Obstacle::Shape::wire: meet_wire(o, d, obstacle, index, hit); break;
        }
    }
    return hit;
}

const Surface& surface_of(const Course& course, std::int16_t object) {
    return object == ground_index ? course.ground
           : object < 0           ? course.wall
                                  : course.obstacles[static_cast<std::size_t>(object)].surface;
}

/// One eye: its place and the directions of its rays in the robot's frame.
class Eye {
public:
    Eye(const Course& course, const CourseCamera& camera, bool right) : camera_(camera) {
        const double pitch = course.pitch_deg * std::numbers::pi / 180;
        const double roll = course.roll_deg * std::numbers::pi / 180;
        ahead_ = {std::cos(pitch), 0, -std::sin(pitch)};
        left_ = {std::sin(pitch) * std::sin(roll), std::cos(roll), std::cos(pitch) * std::sin(roll)};
        up_ = {std::sin(pitch) * std::cos(roll), -std::sin(roll), std::cos(pitch) * std::cos(roll)};
        place = Point{0, 0, camera.height_m} + (right ? -camera.baseline_m : 0.0) * left_;
    }

    Point direction(double x, double y) const {
        const double u = (x - (camera_.width - 1) / 2.0) / camera_.f;
        const double v = (y - (camera_.height - 1) / 2.0) / camera_.f;
        return ahead_ + (-u) * left_ + (-v) * up_;
    }

    /// Whether a point lies in the image.
    bool shows(Point p) const {
        const Point way = p + (-1.0) * place;
        const auto along = [&way](Point axis) { return way.x * axis.x + way.y * axis.y + way.z * axis.z; };
        const double depth = along(ahead_);
        return depth > 0 && std::abs(along(left_)) / depth * camera_.f <= (camera_.width - 1) / 2.0 &&
               std::abs(along(up_)) / depth * camera_.f <= (camera_.height - 1) / 2.0;
    }

    Point place;

private:
    const CourseCamera& camera_;
    Point ahead_, left_, up_;
};

double seen(const Course& course, const Eye& eye, const CourseCamera& camera, double x, double y) {
    const Point direction = eye.direction(x, y);
    const Hit hit = cast(course, eye.place, direction);
    if (hit.object == nothing_index) {
        return 250;
    }
    const std::uint32_t seed = course.seed * 7919U + static_cast<std::uint32_t>(hit.object + 8);
    return luma(surface_of(course, hit.object), eye.place + hit.distance * direction, hit.distance / camera.f, seed);
}

void draw_eye(const Course& course, const CourseCamera& camera, bool right, std::vector<std::uint8_t>& image) {
    const Eye eye(course, camera, right);
    std::mt19937 random(course.seed * 2 + (right ? 1 : 0));
    std::normal_distribution<double> grain(0, course.noise);
    image.reserve(static_cast<std::size_t>(camera.width * camera.height));
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            double sum = 0;
            for (int i = 0; i < rays * rays; ++i) {
                sum += seen(course, eye, camera, x + (i % rays + 0.5) / rays - 0.5, y + (i / rays + 0.5) / rays - 0.5);
            }
            const double value = course.light * sum / (rays * rays) + grain(random);
            image.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L)));
        }
    }
}

}  // namespace

CourseView draw(const Course& course, const CourseCamera& camera) {
    CourseView view;
    draw_eye(course, camera, false, view.left);
    draw_eye(course, camera, true, view.right);
    const Eye eye(course, camera, false);
    const Eye other(course, camera, true);
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            const Point direction = eye.direction(x, y);
            const Hit hit = cast(course, eye.place, direction);
            view.object.push_back(hit.object);
            const Point point = eye.place + (hit.object == nothing_index ? 0.0 : hit.distance) * direction;
            view.point.push_back(point);
            // A ray from the other eye to the point has the length 1 there.
            const Hit seen_by_other = cast(course, other.place, point + (-1.0) * other.place);
            view.both.push_back(other.shows(point) && seen_by_other.distance > 0.99 ? 1 : 0);
        }
    }
    return view;
}

}  // namespace disparityd::eval
