// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>

/// What every parser of outside bytes owes: it takes its input, or refuses it in one line for people.
namespace disparityd::fuzz {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

/// Ends the program, so that the fuzzer keeps the input.
[[noreturn]] inline void fail(const std::string& what) {
    std::fprintf(stderr, "fuzz: %s\n", what.c_str());
    std::abort();
}

inline void expect(bool holds, const char* what) {
    if (!holds) {
        fail(what);
    }
}

/// The line begins with where the fault lies, ends soon, and nothing in it moves the cursor of a terminal.
inline void expect_line(std::string_view line, std::string_view begin) {
    constexpr std::size_t longest = 1000;
    const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
    bool plain = line.starts_with(begin) && line.size() > begin.size() && line.size() <= longest;
    for (const char c : line) {
        plain = plain && !is_control(c);
    }
    if (!plain) {
        fail("this is no line for people that begins with '" + std::string(begin) + "': " + std::string(line));
    }
}

/// Whether the parser took its input. A refusal is an exception of this very type or derived from it; any other one
/// leaves, which ends the program.
template <class Refusal = std::invalid_argument, class Parser>
bool accepted(std::string_view begin, Parser&& parser) {
    try {
        parser();
        return true;
    } catch (const Refusal& refusal) {
        expect_line(refusal.what(), begin);
        return false;
    }
}

}  // namespace disparityd::fuzz
