// SPDX-License-Identifier: Apache-2.0
#include "capture/svo/annex_b.h"

namespace disparityd::capture {
namespace {

/// Tells a sequence parameter set by the head of a unit: one byte in H.264, two in H.265, where the second is 1 for
/// the only layer.
std::optional<AnnexBCodec> parameter_set(std::uint8_t first, std::uint8_t second) {
    constexpr unsigned h264_sps = 7, h265_sps = 33;
    if ((first & 0x80U) != 0) {
        return std::nullopt;
    }
    if (second == 1 && (first & 1U) == 0 && first >> 1U == h265_sps) {
        return AnnexBCodec::h265;
    }
    if ((first & 0x1FU) == h264_sps && (first & 0x60U) != 0) {
        return AnnexBCodec::h264;
    }
    return std::nullopt;
}

}  // namespace

std::optional<AnnexBCodec> annex_b_start(std::span<const std::uint8_t> payload) {
    for (std::size_t i = 0; i + 4 < payload.size(); ++i) {
        if (payload[i] == 0 && payload[i + 1] == 0 && payload[i + 2] == 1) {
            if (const auto codec = parameter_set(payload[i + 3], payload[i + 4])) {
                return codec;
            }
        }
    }
    return std::nullopt;
}

}  // namespace disparityd::capture
