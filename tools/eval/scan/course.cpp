// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/course.h"

#include <cmath>
#include <functional>
#include <random>
#include <utility>

namespace disparityd::eval {
namespace {

/// Makes the parts of one course, each from the next random numbers.
class Maker {
public:
    explicit Maker(std::uint32_t seed) : random_(seed) { course.seed = seed; }

    double between(double least, double most) {
        return least + (most - least) * (static_cast<double>(random_()) / 4294967296.0);
    }

    Surface rough() { return {Surface::Kind::rough, between(70, 170), between(30, 70), between(0.02, 0.05)}; }

    /// A place `metres` ahead within the view, not far from its middle.
    Point place(double metres) { return {metres, metres * between(-0.6, 0.6), 0}; }

    void add_box(Point at, double wide, double high, Surface surface) {
        course.obstacles.push_back(
            {Obstacle::Shape::box, {at.x, at.y, ground_at(at) + high / 2}, {wide / 2, wide / 2, high / 2}, surface});
    }
    void add_post(Point at, double radius, double high, Surface surface) {
        course.obstacles.push_back(
            {Obstacle::Shape::post, {at.x, at.y, ground_at(at) + high / 2}, {radius, 0, high / 2}, surface});
    }
    void add_wire(Point at, double height, double radius, Surface surface) {
        course.obstacles.push_back({Obstacle::Shape::wire, {at.x, at.y, height}, {radius, 2, 0}, surface});
    }
    double ground_at(Point at) const { return course.slope_ahead * at.x + course.slope_left * at.y; }

    /// Boxes and posts at three distances.
    void add_usual() {
        add_box(place(between(0.8, 1.6)), 0.2, between(0.15, 0.5), rough());
        add_post(place(between(1.8, 3)), 0.05, 1, rough());
        add_box(place(between(3.5, 5.5)), 0.4, between(0.3, 0.9), rough());
    }

    Course course;

private:
    std::mt19937 random_;
};

using Kind = std::pair<const char*, std::function<void(Maker&)>>;

const std::vector<Kind>& kinds() {
    static const std::vector<Kind> all{
        {"open floor", [](Maker&) {}},
        {"boxes", [](Maker& m) { m.add_usual(); }},
        {"small boxes",
         [](Maker& m) {
             for (const double metres : {0.8, 1.5, 2.2, 3.0}) {
                 m.add_box(m.place(metres * m.between(0.9, 1.1)), 0.1, 0.2, m.rough());
             }
         }},
        {"thick poles",
         [](Maker& m) {
             for (const double metres : {1.0, 2.0, 3.5, 5.0}) {
                 m.add_post(m.place(metres * m.between(0.9, 1.1)), 0.05, 1.2, m.rough());
             }
         }},
        {"thin poles",
         [](Maker& m) {
             for (const double metres : {0.8, 1.3, 2.0}) {
                 m.add_post(m.place(metres * m.between(0.9, 1.1)), 0.01, 1.2, m.rough());
             }
         }},
        {"wires",
         [](Maker& m) {
             m.add_wire({m.between(1, 2), 0, 0}, m.between(0.35, 0.7), 0.005, m.rough());
         }},
        {"textureless wall",
         [](Maker& m) {
             m.course.obstacles.push_back({Obstacle::Shape::box,
                                           {m.between(1.2, 2.5), m.between(-0.5, 0.5), 0.6},
                                           {0.05, 0.6, 0.6},
                                           {Surface::Kind::plain, m.between(100, 220), 0, 1}});
         }},
        {"ground slopes",
         [](Maker& m) {
             m.course.slope_ahead = std::tan(m.between(-10, 10) * 0.0174533);
             m.course.slope_left = std::tan(m.between(-5, 5) * 0.0174533);
             m.add_usual();
         }},
        {"pitch and roll errors",
         [](Maker& m) {
             m.course.pitch_deg = m.between(-4, 4);
             m.course.roll_deg = m.between(-4, 4);
             m.add_usual();
         }},
        {"noise",
         [](Maker& m) {
             m.course.noise = m.between(5, 8);
             m.add_usual();
         }},
        {"low light",
         [](Maker& m) {
             m.course.light = m.between(0.1, 0.2);
             m.add_usual();
         }},
        {"repeated texture",
         [](Maker& m) {
             const Point at = m.place(m.between(1.2, 3));
             m.add_box(at, 0.6, 0.8, {Surface::Kind::striped, 120, 70, m.between(0.03, 0.08)});
         }},
        {"too near",
         [](Maker& m) {
             m.course.obstacles.push_back({Obstacle::Shape::box,
                                           {m.between(0.3, 0.5), m.between(-0.1, 0.1), 0.3},
                                           {0.03, 0.15, 0.3},
                                           m.rough()});
         }},
    };
    return all;
}

/// A course before anything stands on it.
Maker begun(std::uint32_t seed, const char* kind, int number) {
    Maker maker(seed);
    maker.course.kind = kind;
    maker.course.name = std::string(kind) + " " + std::to_string(number);
    maker.course.ground = maker.rough();
    maker.course.wall = maker.rough();
    maker.course.wall.grain_m = 0.15;
    maker.course.wall_m = maker.between(8, 14);
    return maker;
}

/// A box that comes nearer by more than its size from frame to frame.
void add_approach(Maker maker, std::vector<Course>& courses) {
    constexpr int frames = 6;
    const double wide = maker.between(0.2, 0.6);
    const double high = maker.between(0.3, 0.8);
    const double step = wide + maker.between(0.1, 0.3);
    const double side = maker.between(-0.4, 0.4);
    const double nearest = maker.between(0.9, 1.2) + wide;
    const Surface surface = maker.rough();
    const std::string name = maker.course.name;
    for (int frame = 0; frame < frames; ++frame) {
        const double metres = nearest + step * (frames - 1 - frame);
        maker.course.obstacles.clear();
        maker.add_box({metres, metres * side, 0}, wide, high, surface);
        maker.course.name = name + " frame " + std::to_string(frame + 1);
        maker.course.sequel = frame > 0;
        courses.push_back(maker.course);
    }
}

}  // namespace

std::vector<Course> make_courses(std::uint32_t seed, int count) {
    std::vector<Course> courses;
    std::uint32_t number = 0;
    for (const auto& [kind, fill] : kinds()) {
        for (int i = 0; i < count; ++i) {
            Maker maker = begun(seed * 1000003U + number++, kind, i + 1);
            fill(maker);
            courses.push_back(std::move(maker.course));
        }
    }
    for (int i = 0; i < count; ++i) {
        add_approach(begun(seed * 1000003U + number++, "fast approach", i + 1), courses);
    }
    return courses;
}

}  // namespace disparityd::eval
