// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace disparityd::capture {

/// Takes "KIND:NAME[@RATE][?KEY=VALUE&..]" apart; its refusals name the whole URI. Borrows the text.
class SourceUri {
public:
    struct Parameter {
        std::string_view text;  ///< as written
        std::string_view key;
        std::string_view value;  ///< empty without "="
    };

    explicit SourceUri(const std::string& uri);

    std::string_view name() const { return name_; }
    bool has_rate() const { return rate_.data() != nullptr; }
    std::string_view rate() const { return rate_; }
    /// Throws as fail() where a key comes twice.
    std::vector<Parameter> parameters() const;

    /// Throws std::invalid_argument with one line that says what was found and what is allowed.
    [[noreturn]] void fail(const std::string& what, std::string_view found, const std::string& allowed) const;

    /// Both throw as fail() when the text is no such number, or is not in least .. most.
    double number(const std::string& what, std::string_view text, double least, double most) const;
    int integer(const std::string& what, std::string_view text, int least, int most) const;

private:
    const std::string& uri_;
    std::string_view name_;
    std::string_view rate_;
    std::string_view parameters_;
};

}  // namespace disparityd::capture
