// SPDX-License-Identifier: Apache-2.0
#include "capture/scene/scene_world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace disparityd::capture {

namespace {

// From -1 to 1 and back, smooth, once per loop.
double swing(double phase) {
    const double t = phase - std::floor(phase);
    const double up = 1 - std::abs(2 * t - 1);
    return 2 * up * up * (3 - 2 * up) - 1;
}

std::uint32_t mix(std::uint32_t h) {
    h = (h ^ (h >> 16U)) * 0x7feb352dU;
    h = (h ^ (h >> 15U)) * 0x846ca68bU;
    return h ^ (h >> 16U);
}

// -1 .. 1 at each point of a grid of whole numbers.
double lattice(int x, int y, int z, std::uint32_t seed) {
    const std::uint32_t h =
        mix(static_cast<std::uint32_t>(x) * 0x9e3779b1U + static_cast<std::uint32_t>(y) * 0x85ebca77U +
            static_cast<std::uint32_t>(z) * 0xc2b2ae3dU + seed);
    return static_cast<double>(h >> 8U) * (2.0 / 16777215.0) - 1.0;
}

double smooth(double t) {
    return t * t * (3 - 2 * t);
}

// Value noise: the grid's values, smoothly joined.
double value_noise(Vec3 p, std::uint32_t seed) {
    const double fx = std::floor(p.x);
    const double fy = std::floor(p.y);
    const double fz = std::floor(p.z);
    const int x = static_cast<int>(fx);
    const int y = static_cast<int>(fy);
    const int z = static_cast<int>(fz);
    const double u = smooth(p.x - fx);
    const double v = smooth(p.y - fy);
    const double w = smooth(p.z - fz);
    const auto edge = [&](int dy, int dz) {
        const double a = lattice(x, y + dy, z + dz, seed);
        return a + u * (lattice(x + 1, y + dy, z + dz, seed) - a);
    };
    const double near_side = edge(0, 0) + v * (edge(1, 0) - edge(0, 0));
    const double far_side = edge(0, 1) + v * (edge(1, 1) - edge(0, 1));
    return near_side + w * (far_side - near_side);
}

// Octaves of noise from the largest grain down to what a pixel can still show, about -1 .. 1.
double texture(Vec3 p, double grain, double footprint, std::uint32_t seed) {
    constexpr int octaves = 7;
    constexpr double fall = 0.8;
    double sum = 0;
    double weight = 0.55;
    double wavelength = grain;
    for (int i = 0; i < octaves; ++i) {
        const double visible = std::clamp(0.5 * wavelength / footprint - 1.0, 0.0, 1.0);
        if (visible <= 0) {
            break;
        }
        sum += visible * weight * value_noise((1 / wavelength) * p, seed + static_cast<std::uint32_t>(i) * 7919U);
        weight *= fall;
        wavelength *= 0.5;
    }
    return sum;
}

}  // namespace

SceneWorld::SceneWorld(double phase, std::uint32_t seed) : seed_(mix(seed + 1)) {
    const double sway = swing(phase);
    const double bob = swing(phase + 0.25);
    const auto look = [](double luma, double contrast, double u, double v, double grain) {
        Object object;
        object.luma = luma;
        object.contrast = contrast;
        object.u = u;
        object.v = v;
        object.grain = grain;
        return object;
    };

    add_plane({0, 1150, 0}, {0.04, -1, -0.03}, look(110, 75, 122, 134, 500));
    add_plane({0, 0, 7800}, {-0.35, 0.05, -1}, look(140, 80, 134, 124, 700));

    add_ball({-1250 + 500 * sway, 250 + 120 * bob, 3300}, 430, look(150, 85, 105, 158, 300));
    add_ball({420 - 260 * bob, -420, 2300 + 450 * sway}, 190, look(120, 85, 150, 108, 150));
    add_ball({2100, -700 + 150 * sway, 5200}, 520, look(135, 80, 120, 140, 300));

    add_box({1250, 640, 2700}, {330, 480, 250}, 0.28, look(125, 85, 140, 118, 250));
    add_box({-420, 760, 4300}, {480, 380, 300}, -0.2 + 0.25 * sway, look(145, 80, 116, 146, 350));
    add_box({-2300, 200, 5600}, {420, 950, 420}, 0.12, look(115, 85, 126, 138, 350));
    add_box({620 + 420 * bob, 880, 1500}, {150, 130, 120}, 0.4 * bob, look(140, 85, 110, 120, 120));
    add_box({3000, -200, 6600}, {600, 500, 300}, -0.3, look(150, 75, 138, 132, 400));

    add_rod({-620, 1200, 1900}, {-600, -1500, 1950}, 14, look(90, 70, 128, 128, 60));
    add_rod({1950, 1200, 3600}, {1930, -2200, 3600}, 32, look(165, 70, 120, 132, 80));
    add_rod({-150, 1200, 2900}, {-140, -300, 2880}, 11, look(100, 70, 124, 136, 60));
    add_rod({-3200, -820, 3300}, {3200, -560, 3700}, 7, look(60, 40, 128, 128, 50));
    add_rod({150, 620, 1950}, {1900, 520, 3450}, 12, look(170, 60, 130, 124, 60));
}

void SceneWorld::add_plane(Vec3 point, Vec3 normal, Object look) {
    look.shape = Shape::plane;
    look.centre = point;
    look.axis = (1 / std::sqrt(dot(normal, normal))) * normal;
    planes_.push_back(look);
}

void SceneWorld::add_ball(Vec3 centre, double radius, Object look) {
    look.shape = Shape::ball;
    look.centre = centre;
    look.half_size.x = radius;
    look.bound = radius * radius;
    objects_.push_back(look);
}

void SceneWorld::add_box(Vec3 centre, Vec3 half_size, double half_turn_tangent, Object look) {
    look.shape = Shape::box;
    look.centre = centre;
    look.half_size = half_size;
    const double q = half_turn_tangent * half_turn_tangent;
    look.turn_cos = (1 - q) / (1 + q);
    look.turn_sin = 2 * half_turn_tangent / (1 + q);
    look.bound = dot(half_size, half_size);
    objects_.push_back(look);
}

void SceneWorld::add_rod(Vec3 from, Vec3 to, double radius, Object look) {
    look.shape = Shape::rod;
    look.centre = 0.5 * (from + to);
    look.axis = 0.5 * (to - from);
    look.half_size.x = radius;
    look.bound = std::numeric_limits<double>::infinity();  // long and thin: the test itself is as cheap
    objects_.push_back(look);
}

SceneWorld::Hit SceneWorld::cast(const Ray& ray) const {
    Hit hit;
    hit.distance = std::numeric_limits<double>::infinity();
    int index = 0;
    for (const Object& plane : planes_) {
        const double towards = dot(plane.axis, ray.direction);
        const double t = dot(plane.axis, plane.centre - ray.origin) / towards;
        if (towards != 0 && t > 0 && t < hit.distance) {
            hit.distance = t;
            hit.object = index;
            hit.normal = plane.axis;
        }
        ++index;
    }
    const double length2 = dot(ray.direction, ray.direction);
    for (const Object& object : objects_) {
        const Vec3 to_centre = object.centre - ray.origin;
        const double along = dot(to_centre, ray.direction);
        const bool near = (dot(to_centre, to_centre) - object.bound) * length2 <= along * along;
        if (near) {
            const bool found = object.shape == Shape::ball  ? hits_ball(object, ray, hit)
                               : object.shape == Shape::box ? hits_box(object, ray, hit)
                                                            : hits_rod(object, ray, hit);
            if (found) {
                hit.object = index;
            }
        }
        ++index;
    }
    return hit;
}

bool SceneWorld::is_rod(const Hit& hit) const {
    const int planes = static_cast<int>(planes_.size());
    return hit.object >= planes && objects_[static_cast<std::size_t>(hit.object - planes)].shape == Shape::rod;
}

bool SceneWorld::hits_ball(const Object& object, const Ray& ray, Hit& hit) {
    const Vec3 from_centre = ray.origin - object.centre;
    const double a = dot(ray.direction, ray.direction);
    const double b = dot(from_centre, ray.direction);
    const double c = dot(from_centre, from_centre) - object.bound;
    const double root = b * b - a * c;
    if (root < 0) {
        return false;
    }
    const double t = (-b - std::sqrt(root)) / a;
    if (t <= 0 || t >= hit.distance) {
        return false;
    }
    hit.distance = t;
    hit.normal = (1 / object.half_size.x) * (from_centre + t * ray.direction);
    return true;
}

Vec3 SceneWorld::to_box(const Object& object, Vec3 v) {
    return {object.turn_cos * v.x - object.turn_sin * v.z, v.y, object.turn_sin * v.x + object.turn_cos * v.z};
}

// Slabs, in the box's own axes.
bool SceneWorld::hits_box(const Object& object, const Ray& ray, Hit& hit) {
    const Vec3 origin = to_box(object, ray.origin - object.centre);
    const Vec3 direction = to_box(object, ray.direction);
    double enter = 0;
    double leave = hit.distance;
    Vec3 normal;
    const auto slab = [&](double from, double step, double half, Vec3 side) {
        double first = (-half - from) / step;
        double second = (half - from) / step;
        double facing = -1;
        if (first > second) {
            std::swap(first, second);
            facing = 1;
        }
        if (first > enter) {
            enter = first;
            normal = facing * side;
        }
        leave = std::min(leave, second);
    };
    slab(origin.x, direction.x, object.half_size.x, {object.turn_cos, 0, -object.turn_sin});
    slab(origin.y, direction.y, object.half_size.y, {0, 1, 0});
    slab(origin.z, direction.z, object.half_size.z, {object.turn_sin, 0, object.turn_cos});
    if (enter <= 0 || enter >= leave) {
        return false;
    }
    hit.distance = enter;
    hit.normal = normal;
    return true;
}

bool SceneWorld::hits_rod(const Object& object, const Ray& ray, Hit& hit) {
    const double axis2 = dot(object.axis, object.axis);
    const Vec3 from_centre = ray.origin - object.centre;
    const double direction_along = dot(ray.direction, object.axis) / axis2;
    const double origin_along = dot(from_centre, object.axis) / axis2;
    const Vec3 d = ray.direction - direction_along * object.axis;
    const Vec3 o = from_centre - origin_along * object.axis;
    const double a = dot(d, d);
    const double b = dot(o, d);
    const double c = dot(o, o) - object.half_size.x * object.half_size.x;
    const double root = b * b - a * c;
    if (root < 0 || a == 0) {
        return false;
    }
    const double t = (-b - std::sqrt(root)) / a;
    if (t <= 0 || t >= hit.distance || std::abs(origin_along + t * direction_along) > 1) {
        return false;
    }
    hit.distance = t;
    hit.normal = (1 / object.half_size.x) * (o + t * d);
    return true;
}

SceneWorld::Colour SceneWorld::colour(const Ray& ray, const Hit& hit, double footprint) const {
    const auto planes = static_cast<int>(planes_.size());
    const bool is_plane = hit.object < planes;
    const Object& object = is_plane ? planes_[static_cast<std::size_t>(hit.object)]
                                    : objects_[static_cast<std::size_t>(hit.object - planes)];
    Vec3 place = ray.origin + hit.distance * ray.direction;
    if (object.shape == Shape::box) {
        place = to_box(object, place - object.centre);
    } else if (!is_plane) {
        place = place - object.centre;
    }
    const Vec3 light{-0.4, -0.75, -0.53};
    const double shade = 0.82 + 0.18 * dot(light, hit.normal);
    const double detail =
        texture(place, object.grain, footprint, seed_ + static_cast<std::uint32_t>(hit.object) * 0x51ed27U);
    return {shade * (object.luma + object.contrast * detail), object.u + 10 * detail, object.v - 8 * detail};
}

}  // namespace disparityd::capture
