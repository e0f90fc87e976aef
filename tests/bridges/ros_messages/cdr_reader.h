// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <initializer_list>
#include <string>

#include "formats/cdr_reader.h"

namespace disparityd::test {

/// Returns a string of these bytes.
std::string bytes(std::initializer_list<int> values);

/// Reads a message that it keeps.
class CdrReader : private std::string, public formats::CdrReader {
public:
    explicit CdrReader(const std::string& message);

    /// Reads a std_msgs/msg/Header and returns "SECONDS.NANOSECONDS FRAME".
    std::string header();
};

}  // namespace disparityd::test
