// SPDX-License-Identifier: Apache-2.0
#include "capture/images/inertial_list.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "base/failure_text.h"
#include "base/message_text.h"
#include "base/number_text.h"
#include "base/text_file.h"
#include "base/words.h"
#include "capture/frame_source.h"
#include "capture/images/image_times.h"

namespace disparityd::capture {
namespace {

/// Reads the values behind the time; nothing where there are not six that a float holds.
std::optional<std::array<float, 6>> values_of(std::string_view line) {
    std::array<float, 6> values{};
    const auto fields = base::split(line, ',');
    if (fields.size() != values.size()) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto number = base::parse_number(base::trim(fields[i]));
        if (!number || std::abs(*number) > std::numeric_limits<float>::max()) {
            return std::nullopt;
        }
        values[i] = static_cast<float>(*number);
    }
    return values;
}

}  // namespace

InertialList::InertialList(std::string path) : path_(std::move(path)), file_(path_) {
    if (!file_) {
        throw std::invalid_argument(path_ + ": cannot be read: " + base::error_text(errno) + without_inertial_sensor);
    }
}

void InertialList::take_until(std::int64_t time_ns, std::vector<SensorSample>& samples) {
    samples.clear();
    std::uint32_t lost = 0;
    std::size_t oldest = 0;
    for (; (next_ || (next_ = read())) && next_->camera_ns <= time_ns; next_.reset()) {
        if (samples.size() < RawFrame::most_samples) {
            samples.push_back(*next_);
        } else {
            samples[oldest] = *next_;
            oldest = (oldest + 1) % samples.size();
            ++lost;
        }
    }
    std::rotate(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(oldest), samples.end());
    if (lost > 0) {
        samples.front().lost_before = lost;
    }
}

void InertialList::skip_until(std::int64_t time_ns) {
    while ((next_ || (next_ = read())) && next_->camera_ns <= time_ns) {
        next_.reset();
    }
}

void InertialList::rewind() {
    file_.clear();
    file_.seekg(0);
    next_.reset();
    last_ns_.reset();
    line_ = 0;
}

std::optional<SensorSample> InertialList::read() {
    std::array<char, 512> text{};
    while (file_.getline(text.data(), text.size())) {
        ++line_;
        const std::string_view whole(text.data(), static_cast<std::size_t>(file_.gcount()));
        std::string_view line = base::trim(std::string_view(text.data()));
        if (line_ == 1) {
            line = base::trim(base::without_byte_order_mark(line));
        }
        if (line.empty() || line.front() == '#') {
            continue;
        }
        const std::string shown = base::printable(line);
        const auto time = take_time(line);
        const auto values = time ? values_of(line) : std::nullopt;
        if (!values || whole.substr(0, whole.size() - 1).find('\0') != std::string_view::npos) {
            fail("found '" + shown +
                 "', expected the time in ns, the angular velocity x, y, z in rad/s and the acceleration x, y, z in "
                 "m/s2, with commas between them");
        }
        if (last_ns_ && *time <= *last_ns_) {
            fail("found the time " + std::to_string(*time) + ", expected more than " + std::to_string(*last_ns_) +
                 ", the one above it");
        }
        last_ns_ = time;
        const auto& v = *values;
        SensorSample sample;
        sample.camera_ns = *time;
        sample.flags = sensor_flag_inertial;
        sample.angular_velocity = {v[0], v[1], v[2]};
        sample.acceleration = {v[3], v[4], v[5]};
        return sample;
    }
    if (!file_.eof()) {
        ++line_;
        fail(file_.bad() ? "cannot be read" : "found a line of more than 511 bytes, which is no sample");
    }
    return std::nullopt;
}

void InertialList::fail(const std::string& what) const {
    throw std::runtime_error(path_ + ":" + std::to_string(line_) + ": " + what + without_inertial_sensor);
}

}  // namespace disparityd::capture
