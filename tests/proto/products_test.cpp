// SPDX-License-Identifier: Apache-2.0
//
// The clients and docs/protocol.md name each product again: they say the same as proto/products.h.
#include "proto/products.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "tests/proto/command_output.h"

namespace {

namespace proto = disparityd::proto;

using Numbers = std::map<std::string, int>;

std::string upper_case(std::string_view text) {
    std::string upper(text);
    std::transform(upper.begin(), upper.end(), upper.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    return upper;
}

/// Returns what a file of the project has between two texts.
std::string part_of(const std::string& file, const std::string& begin, const std::string& end) {
    std::ifstream stream(std::string(SOURCES) + '/' + file);
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    const std::size_t from = text.find(begin);
    const std::size_t to = text.find(end, from);
    EXPECT_NE(from, std::string::npos) << file << " has no " << begin;
    EXPECT_NE(to, std::string::npos) << file << " has no " << end;
    return from == std::string::npos || to == std::string::npos ? "" : text.substr(from, to - from);
}

/// Returns the names and numbers that a pattern finds; `name` and `number` are its groups.
Numbers numbers_in(const std::string& text, const std::string& pattern, std::size_t name, std::size_t number) {
    Numbers found;
    const std::regex regex(pattern);
    for (std::sregex_iterator match(text.begin(), text.end(), regex), end; match != end; ++match) {
        found[upper_case((*match)[name].str())] = std::stoi((*match)[number].str());
    }
    return found;
}

Numbers wanted() {
    Numbers numbers;
    for (const proto::ProductInfo& product : proto::products) {
        numbers[upper_case(product.name)] = product.number;
    }
    return numbers;
}

TEST(Products, ProtobufHasTheSameNames) {
    for (const proto::ProductInfo& product : proto::products) {
        EXPECT_EQ(disparityd::v1::Product_Name(product.number), upper_case(product.name));
    }
}

TEST(Products, HeaderForCHasTheSameTable) {
    EXPECT_EQ(numbers_in(part_of("clients/cpp/disparity_client.h", "enum {\n    DISPARITY_PRODUCT_", "};"),
                         "DISPARITY_PRODUCT_([A-Z_]+) = ([0-9]+)", 1, 2),
              wanted());
}

TEST(Products, HeaderForCppHasTheSameTable) {
    EXPECT_EQ(numbers_in(part_of("clients/cpp/disparity_client.hpp", "enum class Product", "};"),
                         "\n +([a-z_]+) = ([0-9]+)", 1, 2),
              wanted());
}

TEST(Products, PageOfTheProtocolHasTheSameTable) {
    EXPECT_EQ(numbers_in(part_of("docs/protocol.md", "| number | name | pixel |", "\n\n"),
                         "\n\\| ([0-9]+) \\| ([A-Z_]+) \\|", 2, 1),
              wanted());
}

TEST(Products, PythonHasTheSameTable) {
    const std::string python = PYTHON_PRODUCTS;
    if (python.empty()) {
        GTEST_SKIP() << "no Python for this machine's programs";
    }
    std::string table;
    for (const proto::ProductInfo& product : proto::products) {
        table += std::to_string(product.number) + ' ' + std::string(product.name) + ' ' +
                 std::to_string(product.bytes_per_pixel) + '\n';
    }
    const auto [status, text] = command_output(python);
    if (status == 77) {
        GTEST_SKIP() << "numpy or protobuf is not installed for Python";
    }
    EXPECT_EQ(status, 0);
    EXPECT_EQ(text, table);
}

}  // namespace
