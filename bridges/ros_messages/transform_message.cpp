// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/transform_message.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bridges/ros_messages/message_header.h"

namespace disparityd::ros {

std::array<double, 4> quaternion(const std::array<double, 9>& m) {
    // Of the four parts the largest is found by a root, which is then far from 0; the others follow from it.
    const double trace = m[0] + m[4] + m[8];
    const std::array<double, 4> squares{1 + 2 * m[0] - trace, 1 + 2 * m[4] - trace, 1 + 2 * m[8] - trace, 1 + trace};
    const auto largest = static_cast<std::size_t>(std::max_element(squares.begin(), squares.end()) - squares.begin());
    std::array<double, 4> q{};
    switch (largest) {
        case 0: q = {squares[0], m[1] + m[3], m[2] + m[6], m[7] - m[5]}; break;
        case 1: q = {m[1] + m[3], squares[1], m[5] + m[7], m[2] - m[6]}; break;
        case 2: q = {m[2] + m[6], m[5] + m[7], squares[2], m[3] - m[1]}; break;
        default: q = {m[7] - m[5], m[2] - m[6], m[3] - m[1], squares[3]}; break;
    }
    const double length = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
    const double divisor = q[3] < 0 ? -length : length;
    for (double& part : q) {
        part /= divisor;
    }
    return q;
}

std::array<double, 4> quaternion_of_degrees(double roll, double pitch, double yaw) {
    constexpr double half = std::numbers::pi / 360;
    const double cr = std::cos(roll * half);
    const double sr = std::sin(roll * half);
    const double cp = std::cos(pitch * half);
    const double sp = std::sin(pitch * half);
    const double cy = std::cos(yaw * half);
    const double sy = std::sin(yaw * half);
    return {sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy};
}

std::string transform_message(std::int64_t realtime_ns, std::span<const Transform> transforms) {
    CdrWriter cdr(192 * transforms.size());
    cdr.length(transforms.size());
    for (const Transform& transform : transforms) {
        write_header(cdr, realtime_ns, transform.parent);
        cdr.text(transform.child).f64_array(transform.translation).f64_array(transform.rotation);
    }
    return cdr.take();
}

}  // namespace disparityd::ros
