// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "obstacles/scan.h"
#include "obstacles/scan_options.h"

namespace disparityd::daemon {

/// Writes the bytes of the product SCAN (proto/scan.h) to `bytes`, which gets their size. `options` are those that the
/// scan was made with.
void put_scan(const Scan& scan, const ScanOptions& options, std::vector<std::uint8_t>& bytes);

}  // namespace disparityd::daemon
