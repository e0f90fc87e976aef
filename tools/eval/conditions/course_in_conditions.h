// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "tools/eval/conditions/condition.h"
#include "tools/eval/scan/course.h"

namespace disparityd::eval {

/// What stands in a course, and what is true of each pixel of its left image. One thread at a time.
class TrueCourse {
public:
    TrueCourse(Course is, const CourseCamera& camera) : course(std::move(is)), camera_(camera) {}

    /// The view has no images. It is drawn when it is first asked for.
    const CourseView& view() const;

    const Course course;

private:
    CourseCamera camera_;
    mutable std::optional<CourseView> view_;
};

/// A pair of images and what it shows.
struct Taken {
    EyePair images;
    std::shared_ptr<const TrueCourse> truth;
};

/// One course in any condition. What stays the same is drawn once. One thread at a time.
class CourseInConditions {
public:
    /// `frame`: of a robot that drives through the course; each has other noise and other weather.
    CourseInConditions(const Course& course, const CourseCamera& camera, std::uint32_t frame = 0);

    /// The course as it is, with a good sensor's noise.
    Taken clean() const;

    /// The course in a condition, by a strength that the course and the condition's name draw.
    Taken in(const Condition& condition, Strength strength) const;

private:
    Light light() const;
    Light light_of(const Course& changed) const;
    EyePair images_before(double degrees, Draws& draws) const;

    CourseCamera camera_;
    std::uint32_t frame_;
    std::uint32_t noise_seed_;
    std::shared_ptr<const TrueCourse> truth_;
    std::array<std::vector<double>, 2> luma_;  ///< of the course as it is, left and right
};

}  // namespace disparityd::eval
