// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/toml_depth.h"

#include <algorithm>
#include <cstddef>

namespace disparityd::daemon {
namespace {

/// Scans a text once. It takes nothing for a string or a comment that a parser of TOML would parse. Where the two could
/// differ, such as at a string that does not end, the parser refuses the text.
class DepthScan {
public:
    explicit DepthScan(std::string_view text) : text_(text) {}

    enum class Found { nothing, long_key, deep_brackets };

    Found run() {
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '"' || c == '\'') {
                skip_string(c);
                continue;
            }
            if (c == '#') {
                at_ = std::min(text_.find('\n', at_), text_.size());
                continue;
            }
            ++at_;
            if (c == '.' && ++dots_ >= deepest_toml) {
                return Found::long_key;
            }
            if ((c == '[' || c == '{') && ++brackets_ > deepest_toml) {
                return Found::deep_brackets;
            }
            if ((c == ']' || c == '}') && brackets_ > 0) {
                --brackets_;
            }
            if (c == '\n') {
                ++line_;
            }
            if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) {
                dots_ = 0;  // another key or value begins
            }
        }
        return Found::nothing;
    }

    std::size_t line() const { return line_; }

private:
    void skip_string(char quote) {
        const std::string three(3, quote);
        if (!text_.substr(at_).starts_with(three)) {
            ++at_;
            skip_to_end(quote);
            return;
        }
        at_ += 3;
        while (at_ < text_.size() && !text_.substr(at_).starts_with(three)) {
            const bool escapes = quote == '"' && text_[at_] == '\\';
            line_ += text_[at_] == '\n' ? 1 : 0;
            ++at_;
            if (escapes && at_ < text_.size() && text_[at_] != '\n') {
                ++at_;
            }
        }
        // Up to two more quotes belong to the string itself.
        constexpr int most_quotes = 3 + 2;
        for (int i = 0; i < most_quotes && at_ < text_.size() && text_[at_] == quote; ++i) {
            ++at_;
        }
    }

    /// A string of one line ends with its quote or, where that is missing, with the line.
    void skip_to_end(char quote) {
        while (at_ < text_.size() && text_[at_] != '\n') {
            const char c = text_[at_];
            at_ += quote == '"' && c == '\\' && at_ + 1 < text_.size() && text_[at_ + 1] != '\n' ? 2 : 1;
            if (c == quote) {
                return;
            }
        }
    }

    std::string_view text_;
    std::size_t at_ = 0;
    std::size_t line_ = 1;
    int dots_ = 0;
    int brackets_ = 0;
};

}  // namespace

std::string toml_depth_problem(std::string_view text, const std::string& name) {
    DepthScan scan(text);
    const auto found = scan.run();
    const std::string where = name + ':' + std::to_string(scan.line()) + ": found ";
    const std::string most = std::to_string(deepest_toml);
    switch (found) {
        case DepthScan::Found::nothing: return {};
        case DepthScan::Found::long_key:
            return where + "a key of more than " + most + " parts with dots between them, allowed: at most " + most +
                   "; keys of disparityd have two: section.key";
        case DepthScan::Found::deep_brackets:
            return where + "more than " + most + " brackets inside each other, allowed: at most " + most +
                   "; values of disparityd have one at most";
    }
    return {};
}

}  // namespace disparityd::daemon
