// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>

#include "tools/eval/draws.h"
#include "tools/eval/scan/course.h"

namespace disparityd::eval {

/// Makes the parts of one course, each from the next random numbers. One thread uses it.
class CourseMaker {
public:
    explicit CourseMaker(std::uint32_t seed) : draws_(seed) { course.seed = seed; }
    /// Adds to a course.
    CourseMaker(Course to, std::uint32_t seed) : course(std::move(to)), draws_(seed) {}

    double between(double least, double most) { return draws_.between(least, most); }

    Surface rough() { return {Surface::Kind::rough, between(70, 170), between(30, 70), between(0.02, 0.05)}; }

    /// A place `metres` ahead within the view, not far from its middle.
    Point place(double metres) { return {metres, metres * between(-0.6, 0.6), 0}; }

    void add_box(Point at, double wide, double high, const Surface& surface) {
        course.obstacles.push_back(
            {Obstacle::Shape::box, {at.x, at.y, ground_at(at) + high / 2}, {wide / 2, wide / 2, high / 2}, surface});
    }
    void add_post(Point at, double radius, double high, const Surface& surface) {
        course.obstacles.push_back(
            {Obstacle::Shape::post, {at.x, at.y, ground_at(at) + high / 2}, {radius, 0, high / 2}, surface});
    }
    void add_wire(Point at, double height, double radius, const Surface& surface) {
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
    Draws draws_;
};

}  // namespace disparityd::eval
