// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "clients/cpp/disparity_client.hpp"

namespace disparity {

/// Reads the bytes of the product SCAN, which may be anything: those of a borrowed frame may change meanwhile. Throws
/// std::runtime_error when they have another version or another length than their head says.
Scan read_scan(const std::uint8_t* bytes, std::size_t size);

}  // namespace disparity
