// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tools/eval/scan/course.h"
#include "tools/eval/scan/surface_luma.h"

namespace disparityd::eval {
namespace {

constexpr std::int16_t ground_index = -1;
constexpr std::int16_t wall_index = -2;
constexpr std::int16_t nothing_index = -3;

struct Hit {
    double distance = std::numeric_limits<double>::infinity();
    std::int16_t object = nothing_index;
};

/// The part of a ray, from 0 to `far`, that lies in a box; empty where near >= far.
struct Inside {
    double near = 0;
    double far = 0;
};

Inside inside_of(Point o, Point d, const Obstacle& box, double far) {
    Inside inside{0, far};
    const std::array<std::array<double, 4>, 3> axes{{{o.x, d.x, box.centre.x, box.half.x},
                                                     {o.y, d.y, box.centre.y, box.half.y},
                                                     {o.z, d.z, box.centre.z, box.half.z}}};
    for (const auto& [from, step, middle, half] : axes) {
        const double a = (middle - half - from) / step;
        const double b = (middle + half - from) / step;
        inside.near = std::max(inside.near, std::min(a, b));
        inside.far = std::min(inside.far, std::max(a, b));
    }
    return inside;
}

void meet_box(Point o, Point d, const Obstacle& box, std::int16_t index, Hit& hit) {
    const Inside inside = inside_of(o, d, box, hit.distance);
    if (inside.near < inside.far && inside.near > 0) {
        hit = {inside.near, index};
    }
}

/// A ray that meets the ground where a hole is ends at the hole's floor or at its far side.
void fall_in_hole(Point o, Point d, const Obstacle& hole, std::int16_t index, Hit& hit) {
    const double x = o.x + hit.distance * d.x - hole.centre.x;
    const double y = o.y + hit.distance * d.y - hole.centre.y;
    if (std::abs(x) < hole.half.x && std::abs(y) < hole.half.y) {
        hit = {inside_of(o, d, hole, std::numeric_limits<double>::infinity()).far, index};
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

void meet_bar(Point o, Point d, const Obstacle& bar, std::int16_t index, Hit& hit) {
    const double half_length = std::hypot(bar.half.y, bar.half.z);
    const double left = bar.half.y / half_length;
    const double up = bar.half.z / half_length;
    const double y = o.y - bar.centre.y;
    const double z = o.z - bar.centre.z;
    // Across the bar lie x and the direction at right angles to both.
    const double t = to_cylinder(o.x - bar.centre.x, z * left - y * up, d.x, d.z * left - d.y * up, bar.half.x);
    if (t > 0 && t < hit.distance && std::abs((y + t * d.y) * left + (z + t * d.z) * up) <= half_length) {
        hit = {t, index};
    }
}

/// `but_for`: an object that the ray goes through.
Hit cast(const Course& course, Point o, Point d, std::int16_t but_for = nothing_index) {
    Hit hit;
    if (d.x > 0) {
        hit = {(course.wall_m - o.x) / d.x, wall_index};
    }
    const Hit wall = hit;
    const double fall = d.z - course.slope_ahead * d.x - course.slope_left * d.y;
    const double above = o.z - course.slope_ahead * o.x - course.slope_left * o.y;
    if (fall < 0 && -above / fall < hit.distance) {
        hit = {-above / fall, ground_index};
    }
    for (std::size_t i = 0; i < course.obstacles.size() && hit.object == ground_index; ++i) {
        if (course.obstacles[i].shape == Obstacle::Shape::hole) {
            fall_in_hole(o, d, course.obstacles[i], static_cast<std::int16_t>(i), hit);
            hit = hit.distance < wall.distance ? hit : wall;
        }
    }
    for (std::size_t i = 0; i < course.obstacles.size(); ++i) {
        const Obstacle& obstacle = course.obstacles[i];
        const auto index = static_cast<std::int16_t>(i);
        if (index == but_for) {
            continue;
        }
        switch (obstacle.shape) {
            case Obstacle::Shape::box: meet_box(o, d, obstacle, index, hit); break;
            case Obstacle::Shape::post: meet_post(o, d, obstacle, index, hit); break;
            case Obstacle::Shape::wire: meet_wire(o, d, obstacle, index, hit); break;
            case Obstacle::Shape::bar: meet_bar(o, d, obstacle, index, hit); break;
            case Obstacle::Shape::hole: break;
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
    Eye(const Course& course, const CourseCamera& camera, bool right, const EyeError& error = {})
        : camera_(camera), f_(camera.f * error.focal), rows_(error.rows) {
        const double pitch = course.pitch_deg * std::numbers::pi / 180;
        const double roll = course.roll_deg * std::numbers::pi / 180;
        const double robot_yaw = camera.yaw_deg * std::numbers::pi / 180;
        const double yaw = robot_yaw + error.yaw_deg * std::numbers::pi / 180;
        const auto turned = [yaw](Point p) {
            return Point{p.x * std::cos(yaw) - p.y * std::sin(yaw), p.x * std::sin(yaw) + p.y * std::cos(yaw), p.z};
        };
        ahead_ = turned({std::cos(pitch), 0, -std::sin(pitch)});
        left_ = turned({std::sin(pitch) * std::sin(roll), std::cos(roll), std::cos(pitch) * std::sin(roll)});
        up_ = turned({std::sin(pitch) * std::cos(roll), -std::sin(roll), std::cos(pitch) * std::cos(roll)});
        place = Point{camera.x_m + error.ahead_m * std::cos(robot_yaw),
                      camera.y_m + error.ahead_m * std::sin(robot_yaw), camera.height_m} +
                (right ? -camera.baseline_m : 0.0) * left_;
    }

    Point direction(double x, double y) const {
        const double u = (x - (camera_.width - 1) / 2.0) / f_;
        const double v = (y + rows_ - (camera_.height - 1) / 2.0) / f_;
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
    double f_;
    double rows_;
    Point ahead_, left_, up_;
};

/// A ray of light, traced back: where it is, where it comes from, and how far it has come since it was a ray of the
/// camera, in lengths of the direction.
struct Ray {
    Point from;
    Point direction;
    double before = 0;
};

double seen(const Course& course, const CourseCamera& camera, const Ray& ray, std::int16_t but_for = nothing_index);

/// The finest structure that a lens shows after so many lengths of a direction: a pixel, or two where one ray is cast.
double finest_m(const CourseCamera& camera, double lengths) {
    constexpr double usual_rays = 2;
    return lengths / camera.f * (usual_rays / camera.rays);
}

/// What a ray that was sent back along x shows: the ground, what stands there, or the wall behind the robot, which
/// looks as the one ahead.
double reflected(const Course& course, const CourseCamera& camera, Ray ray, std::int16_t mirror) {
    ray.direction.x = -ray.direction.x;
    constexpr double behind_m = 3;
    const double to_wall = (-behind_m - ray.from.x) / ray.direction.x;
    if (cast(course, ray.from, ray.direction, mirror).distance < to_wall) {
        return seen(course, camera, ray, mirror);
    }
    return luma(course.wall, ray.from + to_wall * ray.direction, finest_m(camera, ray.before + to_wall), course.seed);
}

double seen(const Course& course, const CourseCamera& camera, const Ray& ray, std::int16_t but_for) {
    const Hit hit = cast(course, ray.from, ray.direction, but_for);
    if (hit.object == nothing_index) {
        return 250;
    }
    const Surface& surface = surface_of(course, hit.object);
    const Ray on{ray.from + hit.distance * ray.direction, ray.direction, ray.before + hit.distance};
    const std::uint32_t seed = course.seed * 7919U + static_cast<std::uint32_t>(hit.object + 8);
    const double own = luma(surface, on.from, finest_m(camera, on.before), seed);
    // A ray that has met a mirror or glass already sees what the next one is made of.
    if (but_for != nothing_index) {
        return own;
    }
    constexpr double glass_reflects = 0.08;
    const double reflects = surface.kind == Surface::Kind::mirror  ? surface.share
                            : surface.kind == Surface::Kind::glass ? surface.share * glass_reflects
                                                                   : 0;
    const double passes = surface.kind == Surface::Kind::glass ? surface.share - reflects : 0;
    return (1 - reflects - passes) * own + (reflects > 0 ? reflects * reflected(course, camera, on, hit.object) : 0) +
           (passes > 0 ? passes * seen(course, camera, on, hit.object) : 0);
}

/// Direction `i` of the rays * rays of a pixel.
Point direction_in_pixel(const CourseCamera& camera, const Eye& eye, int x, int y, int i) {
    const int rays = camera.rays;
    return eye.direction(x + (i % rays + 0.5) / rays - 0.5, y + (i / rays + 0.5) / rays - 0.5);
}

double luma_of_pixel(const Course& course, const CourseCamera& camera, const Eye& eye, int x, int y) {
    const int count = camera.rays * camera.rays;
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        sum += seen(course, camera, {eye.place, direction_in_pixel(camera, eye, x, y, i)});
    }
    return sum / count;
}

std::vector<std::uint8_t> with_grain(const std::vector<double>& luma, const Course& course, bool right) {
    std::mt19937 random(course.seed * 2 + (right ? 1 : 0));
    std::normal_distribution<double> grain(0, course.noise);
    std::vector<std::uint8_t> image;
    image.reserve(luma.size());
    for (const double value : luma) {
        const long level = std::lround(course.light * value + grain(random));
        image.push_back(static_cast<std::uint8_t>(std::clamp(level, 0L, 255L)));
    }
    return image;
}

/// Where a ray enters a hole's opening on the level ground, seen from above.
Point edge_of_hole(Point o, Point d, const Obstacle& hole) {
    const double t = inside_of({o.x, o.y, hole.centre.z}, {d.x, d.y, 0}, hole, 1e9).near;
    return {o.x + t * d.x, o.y + t * d.y, 0};
}

}  // namespace

std::vector<double> draw_luma(const Course& course, const CourseCamera& camera, bool right, const EyeError& error) {
    const Eye eye(course, camera, right, error);
    std::vector<double> image;
    image.reserve(static_cast<std::size_t>(camera.width * camera.height));
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            image.push_back(luma_of_pixel(course, camera, eye, x, y));
        }
    }
    return image;
}

std::vector<double> draw_depth(const Course& course, const CourseCamera& camera) {
    const Eye eye(course, camera, false);
    std::vector<double> depth;
    depth.reserve(static_cast<std::size_t>(camera.width * camera.height));
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            depth.push_back(cast(course, eye.place, eye.direction(x, y)).distance);
        }
    }
    return depth;
}

void draw_added(const Course& course, const CourseCamera& camera, bool right, std::size_t first_added,
                std::vector<double>& luma) {
    const Eye eye(course, camera, right);
    for (int i = 0; i < camera.width * camera.height; ++i) {
        const int x = i % camera.width;
        const int y = i / camera.width;
        bool met = false;
        for (int ray = 0; ray < camera.rays * camera.rays && !met; ++ray) {
            const Hit hit = cast(course, eye.place, direction_in_pixel(camera, eye, x, y, ray));
            met = hit.object >= static_cast<int>(first_added);
        }
        if (met) {
            luma[static_cast<std::size_t>(i)] = luma_of_pixel(course, camera, eye, x, y);
        }
    }
}

CourseView draw(const Course& course, const CourseCamera& camera) {
    CourseView view;
    view.left = with_grain(draw_luma(course, camera, false, {}), course, false);
    view.right = with_grain(draw_luma(course, camera, true, {}), course, true);
    add_truth(course, camera, view);
    return view;
}

void add_truth(const Course& course, const CourseCamera& camera, CourseView& view) {
    const Eye eye(course, camera, false);
    const Eye other(course, camera, true);
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            const Point direction = eye.direction(x, y);
            const Hit hit = cast(course, eye.place, direction);
            view.object.push_back(hit.object);
            const Point point = eye.place + (hit.object == nothing_index ? 0.0 : hit.distance) * direction;
            const bool hole = hit.object >= 0 &&
                              course.obstacles[static_cast<std::size_t>(hit.object)].shape == Obstacle::Shape::hole;
            view.point.push_back(
                hole ? edge_of_hole(eye.place, direction, course.obstacles[static_cast<std::size_t>(hit.object)])
                     : point);
            // A ray from the other eye to the point has the length 1 there.
            const Hit seen_by_other = cast(course, other.place, point + (-1.0) * other.place);
            view.both.push_back(other.shows(point) && seen_by_other.distance > 0.99 ? 1 : 0);
        }
    }
}

}  // namespace disparityd::eval
