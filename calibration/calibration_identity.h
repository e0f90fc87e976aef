// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace disparityd::calibration {

/// Returns what identifies a calibration in recordings and correction files: the 64-bit FNV-1a hash of the text of
/// to_text(), as 16 hexadecimal digits.
std::string calibration_identity(std::string_view calibration_text);

}  // namespace disparityd::calibration
