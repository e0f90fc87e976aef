// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace disparityd::capture {

/// Names a file that is no video but something else that people have: recordings of other programs, archives, images.
/// Returns what it is and how to get from there to something that is read; nothing where it is none of these. `head`
/// are its first bytes.
std::optional<std::string> known_otherwise(const std::string& path, std::span<const std::uint8_t> head);

}  // namespace disparityd::capture
