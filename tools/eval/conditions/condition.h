// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <opencv2/core.hpp>

#include "tools/eval/draws.h"
#include "tools/eval/scan/course.h"
#include "tools/eval/scan/course_maker.h"

/// Bad conditions that a course is seen in. What is true stays so: it is what the left eye sees at the frame's instant.
namespace disparityd::eval {

/// The left and the right image, 8 bit grey.
using EyePair = std::array<cv::Mat, 2>;

/// How an eye's sensor is noisy. One sigma of a grey level is the root of read * read + shot * level.
struct Sensor {
    double read = 1.5;
    double shot = 0;
    bool shared = false;  ///< neighbours share the noise, as after a camera's own filter
};

/// What arrives at the sensors: grey levels as 32-bit floating point, without noise or limits, left and right.
struct Light {
    std::array<cv::Mat, 2> eyes;
    Sensor sensor;
};

// What a condition changes, by a strength in the condition's unit.
using ChangeCourse = void (*)(CourseMaker&, double);      ///< what stands there
using ChangeRightEye = EyeError (*)(double, Draws&);      ///< where the right eye is
using ChangeLight = void (*)(Light&, double, Draws&);     ///< what arrives at the sensors
using ChangePixels = void (*)(EyePair&, double, Draws&);  ///< the finished images
/// Mixes in what the eyes saw one frame before; the robot has turned by so many degrees since.
using MixFrames = void (*)(EyePair&, const EyePair& before, Draws&);
using Change = std::variant<ChangeCourse, ChangeRightEye, ChangeLight, ChangePixels, MixFrames>;

enum class Strength : std::uint8_t { low, middle, high };
inline constexpr std::array<Strength, 3> all_strengths{Strength::low, Strength::middle, Strength::high};
std::string_view to_string(Strength strength);

struct StrengthRange {
    double from = 0;
    double to = 0;
};

/// A row of the table of conditions.
struct Condition {
    std::string_view name;
    std::string_view group;               ///< whose picture shows it
    std::string_view unit;                ///< of a strength: "px", "% of the light left"
    std::array<StrengthRange, 3> ranges;  ///< low, middle, high: a course draws one strength of it
    Change change;
    bool close = false;  ///< the picture shows a part of the image in its own size: all of it would hide what changes

    const StrengthRange& range(Strength strength) const { return ranges[static_cast<std::size_t>(strength)]; }
};

/// All conditions, in the order of the table; those of one group follow each other.
std::span<const Condition> conditions();

/// Returns the conditions of these names, in the table's order; all for none. Throws std::invalid_argument with one
/// line for a name that is none.
std::vector<const Condition*> conditions_named(const std::vector<std::string>& names);

/// Returns "low, 2 to 3 grey levels".
std::string strength_text(const Condition& condition, Strength strength);

/// Returns what the sensors make of light, with the noise that `seed` gives.
EyePair exposed(const Light& light, std::uint32_t seed);

}  // namespace disparityd::eval
