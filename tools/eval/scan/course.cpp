// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/scan/course.h"

#include <cmath>
#include <functional>
#include <utility>

#include "tools/eval/scan/course_maker.h"

namespace disparityd::eval {
namespace {

using Kind = std::pair<const char*, std::function<void(CourseMaker&)>>;

const std::vector<Kind>& kinds() {
    static const std::vector<Kind> all{
        {"open floor", [](CourseMaker&) {}},
        {"boxes", [](CourseMaker& m) { m.add_usual(); }},
        {"small boxes",
         [](CourseMaker& m) {
             for (const double metres : {0.8, 1.5, 2.2, 3.0}) {
                 m.add_box(m.place(metres * m.between(0.9, 1.1)), 0.1, 0.2, m.rough());
             }
         }},
        {"thick poles",
         [](CourseMaker& m) {
             for (const double metres : {1.0, 2.0, 3.5, 5.0}) {
                 m.add_post(m.place(metres * m.between(0.9, 1.1)), 0.05, 1.2, m.rough());
             }
         }},
        {"thin poles",
         [](CourseMaker& m) {
             for (const double metres : {0.8, 1.3, 2.0}) {
                 m.add_post(m.place(metres * m.between(0.9, 1.1)), 0.01, 1.2, m.rough());
             }
         }},
        {"wires",
         [](CourseMaker& m) {
             m.add_wire({m.between(1, 2), 0, 0}, m.between(0.35, 0.7), 0.005, m.rough());
         }},
        {"textureless wall",
         [](CourseMaker& m) {
             m.course.obstacles.push_back({Obstacle::Shape::box,
                                           {m.between(1.2, 2.5), m.between(-0.5, 0.5), 0.6},
                                           {0.05, 0.6, 0.6},
                                           {Surface::Kind::plain, m.between(100, 220), 0, 1}});
         }},
        {"ground slopes",
         [](CourseMaker& m) {
             m.course.slope_ahead = std::tan(m.between(-10, 10) * 0.0174533);
             m.course.slope_left = std::tan(m.between(-5, 5) * 0.0174533);
             m.add_usual();
         }},
        {"pitch and roll errors",
         [](CourseMaker& m) {
             m.course.pitch_deg = m.between(-4, 4);
             m.course.roll_deg = m.between(-4, 4);
             m.add_usual();
         }},
        {"noise",
         [](CourseMaker& m) {
             m.course.noise = m.between(5, 8);
             m.add_usual();
         }},
        {"low light",
         [](CourseMaker& m) {
             m.course.light = m.between(0.1, 0.2);
             m.add_usual();
         }},
        {"repeated texture",
         [](CourseMaker& m) {
             const Point at = m.place(m.between(1.2, 3));
             m.add_box(at, 0.6, 0.8, {Surface::Kind::striped, 120, 70, m.between(0.03, 0.08)});
         }},
        {"too near",
         [](CourseMaker& m) {
             m.course.obstacles.push_back({Obstacle::Shape::box,
                                           {m.between(0.3, 0.5), m.between(-0.1, 0.1), 0.3},
                                           {0.03, 0.15, 0.3},
                                           m.rough()});
         }},
    };
    return all;
}

/// A course before anything stands on it.
CourseMaker begun(std::uint32_t seed, const char* kind, int number) {
    CourseMaker maker(seed);
    maker.course.kind = kind;
    maker.course.name = std::string(kind) + " " + std::to_string(number);
    maker.course.ground = maker.rough();
    maker.course.wall = maker.rough();
    maker.course.wall.grain_m = 0.15;
    maker.course.wall_m = maker.between(8, 14);
    return maker;
}

/// A box that comes nearer by more than its size from frame to frame.
void add_approach(CourseMaker maker, std::vector<Course>& courses) {
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

std::vector<Course> make_base_courses(std::uint32_t seed, int count) {
    std::vector<Course> courses;
    for (int i = 0; i < count; ++i) {
        CourseMaker maker = begun(seed * 1000003U + static_cast<std::uint32_t>(i), "base", i + 1);
        const Point near = maker.place(maker.between(0.8, 1.6));
        const double low = maker.between(0.15, 0.5);
        maker.add_box(near, 0.2, low, maker.rough());
        const Point middle = maker.place(maker.between(1.8, 3));
        maker.add_post(middle, 0.05, 1, maker.rough());
        const Point far = maker.place(maker.between(3.5, 5.5));
        const double high = maker.between(0.3, 0.9);
        maker.add_box(far, 0.4, high, maker.rough());
        const Point pole = maker.place(maker.between(0.9, 2));
        maker.add_post(pole, 0.01, 1.2, maker.rough());
        courses.push_back(std::move(maker.course));
    }
    return courses;
}

std::vector<Course> make_courses(std::uint32_t seed, int count) {
    std::vector<Course> courses;
    std::uint32_t number = 0;
    for (const auto& [kind, fill] : kinds()) {
        for (int i = 0; i < count; ++i) {
            CourseMaker maker = begun(seed * 1000003U + number++, kind, i + 1);
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
