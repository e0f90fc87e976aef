// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_format.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <utility>

#include "base/little_endian.h"

namespace disparityd::capture::recording {
namespace {

constexpr std::array<std::uint8_t, 8> block_add_id{0, 0, 0, 0, 0, 0, 0, 1};
constexpr std::size_t facts_without_correction = 48;
constexpr std::array<std::uint8_t, 8> magic{'d', 'i', 's', 'p', 'f', 'r', 'm', '1'};

}  // namespace

std::string frames_text(std::uint64_t frames) {
    const std::string digits = std::to_string(frames);
    return std::string(static_cast<std::size_t>(frames_digits) - digits.size(), '0') + digits;
}

double plausible_rate(double rate) {
    return rate >= 1e-3 && rate <= 1e6 ? rate : 0;
}

void put_facts(const FrameFacts& facts, std::span<std::uint8_t, facts_size> bytes) {
    std::copy(block_add_id.begin(), block_add_id.end(), bytes.begin());
    std::copy(magic.begin(), magic.end(), bytes.begin() + 8);
    base::put_little_endian(&bytes[16], facts.sequence, 8);
    base::put_little_endian(&bytes[24], static_cast<std::uint64_t>(facts.monotonic_ns), 8);
    base::put_little_endian(&bytes[32], static_cast<std::uint64_t>(facts.realtime_ns), 8);
    base::put_little_endian(&bytes[40], facts.flags, 4);
    base::put_little_endian(&bytes[44], facts.dropped_before, 4);
    const calibration::CalibrationCorrection& correction = facts.correction;
    std::uint8_t* to = &bytes[facts_without_correction];
    for (const std::int32_t value :
         {correction.pitch_nrad, correction.yaw_nrad, correction.roll_nrad, correction.focal_ppb}) {
        base::put_little_endian(to, static_cast<std::uint32_t>(value), 4);
        to += 4;
    }
}

std::optional<FrameFacts> get_facts(std::span<const std::uint8_t> bytes) {
    // The first version had no correction. Later versions may add to the end.
    if (bytes.size() < facts_without_correction || !std::equal(magic.begin(), magic.end(), bytes.begin() + 8)) {
        return std::nullopt;
    }
    FrameFacts facts;
    facts.sequence = base::get_little_endian(&bytes[16], 8);
    facts.monotonic_ns = static_cast<std::int64_t>(base::get_little_endian(&bytes[24], 8));
    facts.realtime_ns = static_cast<std::int64_t>(base::get_little_endian(&bytes[32], 8));
    facts.flags = static_cast<std::uint32_t>(base::get_little_endian(&bytes[40], 4));
    facts.dropped_before = static_cast<std::uint32_t>(base::get_little_endian(&bytes[44], 4));
    if (bytes.size() >= facts_size) {
        const auto number = [&bytes](std::size_t index) {
            return static_cast<std::int32_t>(base::get_little_endian(&bytes[facts_without_correction + 4 * index], 4));
        };
        facts.correction = {number(0), number(1), number(2), number(3)};
    }
    return facts;
}

}  // namespace disparityd::capture::recording
