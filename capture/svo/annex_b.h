// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

namespace disparityd::capture {

enum class AnnexBCodec : unsigned char { h264, h265 };

/// Whether a stream of units that begin with 00 00 01 can be decoded from here on: it has the sizes (a sequence
/// parameter set). Returns which codec it is; nothing where it has none.
std::optional<AnnexBCodec> annex_b_start(std::span<const std::uint8_t> payload);

}  // namespace disparityd::capture
