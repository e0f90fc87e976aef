// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/processing/times_csv.h"

#include "tools/command_line/csv.h"

namespace disparityd::tools {
namespace {

/// Members of a frame in the manifest.
constexpr const char* columns[] = {"output", "input",          "sequence", "monotonic_ns",
                                   "flags",  "dropped_before", "trust",    "doubts"};

}  // namespace

std::string times_head() {
    std::string line = "frame,";
    for (const std::string column : columns) {
        line += column + ',';
    }
    return line;
}

std::string times_columns(std::uint64_t index, const Json& frame) {
    constexpr int one_line = -1;
    std::string line = std::to_string(index) + ',';
    for (const char* const column : columns) {
        const Json& value = frame.at(column);
        line += (value.is_string() ? csv_field(value.get<std::string>()) : to_text(value, one_line)) + ',';
    }
    return line;
}

}  // namespace disparityd::tools
