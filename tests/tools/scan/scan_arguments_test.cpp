// SPDX-License-Identifier: Apache-2.0
#include "tools/command_line/scan_arguments.h"

#include <fstream>

#include <gmock/gmock.h>

namespace disparityd::test {
namespace {

/// Returns the keys of a section of the configuration that explains every key.
std::vector<std::string> keys_of(const std::string& wanted) {
    std::ifstream file(DISPARITYD_EXAMPLE_CONFIG);
    std::vector<std::string> keys;
    std::string section;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with('[')) {
            section = line;
        } else if (section == '[' + wanted + ']' && !line.empty() && line[0] != '#') {
            keys.push_back(line.substr(0, line.find(' ')));
        }
    }
    return keys;
}

TEST(ScanArguments, HaveTheNamesOfTheConfiguration) {
    std::vector<std::string> expected = keys_of("scan");
    ASSERT_FALSE(expected.empty());
    EXPECT_EQ(expected.front(), "enabled");
    expected.erase(expected.begin());
    EXPECT_THAT(keys_of("match"), testing::Contains("subpixel_error_px"));
    expected.emplace_back("subpixel_error_px");
    std::vector<std::string> names;
    for (const ScanField& field : scan_fields()) {
        names.emplace_back(field.name);
    }
    EXPECT_EQ(names, expected);
}

}  // namespace
}  // namespace disparityd::test
