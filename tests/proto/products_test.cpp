// SPDX-License-Identifier: Apache-2.0
//
// What the build made of the table of products, and docs/protocol.md, which names each again: they say what
// disparity.proto says.
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

std::string text_of(const std::string& file) {
    std::ifstream stream(file);
    EXPECT_TRUE(stream) << file;
    return {std::istreambuf_iterator<char>(stream), {}};
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
    for (const proto::ProductFacts& product : proto::products) {
        numbers[upper_case(product.name)] = product.number;
    }
    return numbers;
}

TEST(Products, TableSaysWhatProtobufReads) {
    for (const proto::ProductFacts& product : proto::products) {
        const auto* const value = disparityd::v1::Product_descriptor()->FindValueByNumber(product.number);
        const disparityd::v1::ProductInfo& info = value->options().GetExtension(disparityd::v1::product);
        EXPECT_EQ(value->name(), upper_case(product.name));
        EXPECT_EQ(info.type(), product.type) << product.name;
        EXPECT_EQ(info.channels(), product.channels) << product.name;
        EXPECT_EQ(std::stoul(info.type().substr(1)) / 8 * info.channels(), product.bytes_per_pixel) << product.name;
        EXPECT_EQ(info.key(), product.key) << product.name;
        EXPECT_EQ(info.title(), product.title) << product.name;
        EXPECT_EQ(info.unit(), product.unit) << product.name;
        EXPECT_EQ(info.view(), product.view) << product.name;
        EXPECT_EQ(info.shown_max(), product.shown_max) << product.name;
        EXPECT_EQ(info.colour_of(), product.colour_of) << product.name;
    }
}

TEST(Products, HeadersOfTheClientsHaveTheSameNumbers) {
    EXPECT_EQ(numbers_in(text_of(HEADERS "/disparity_products.h"), "DISPARITY_PRODUCT_([A-Z_]+) = ([0-9]+)", 1, 2),
              wanted());
    EXPECT_EQ(numbers_in(text_of(HEADERS "/disparity_products.hpp"), "\n +([a-z_]+) = ([0-9]+)", 1, 2), wanted());
}

TEST(Products, PageOfTheProtocolHasTheSameTable) {
    EXPECT_EQ(numbers_in(text_of(SOURCES "/docs/protocol.md"), "\n\\| ([0-9]+) \\| ([A-Z_]+) \\|", 2, 1), wanted());
}

TEST(Products, PythonHasTheSameTable) {
    const std::string python = PYTHON_PRODUCTS;
    if (python.empty()) {
        GTEST_SKIP() << "no Python for this machine's programs";
    }
    std::string table;
    for (const proto::ProductFacts& product : proto::products) {
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
