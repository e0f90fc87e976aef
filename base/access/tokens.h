// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace disparityd::base {

/// What somebody may do. Each right contains those before it.
enum class Right : unsigned char {
    none,
    view,     ///< frames, status
    control,  ///< recordings, camera controls
};

/// The tokens that a program knows, and the right that each gives.
class Tokens {
public:
    Tokens() = default;
    Tokens(std::vector<std::string> viewers, std::vector<std::string> controllers)
        : viewers_(std::move(viewers)), controllers_(std::move(controllers)) {}

    bool empty() const { return viewers_.empty() && controllers_.empty(); }
    const std::vector<std::string>& viewers() const { return viewers_; }
    const std::vector<std::string>& controllers() const { return controllers_; }

    /// Returns Right::none for a token that is not known. Takes the same time wherever two tokens differ, so that
    /// nobody finds one letter by letter.
    Right right_of(std::string_view token) const;

private:
    std::vector<std::string> viewers_;
    std::vector<std::string> controllers_;
};

/// Reads tokens: each line is "view TOKEN" or "control TOKEN", a token of 16 to 256 printable characters without
/// blanks; empty lines and those that begin with # say nothing. Throws std::invalid_argument with one line: file, line,
/// found, allowed; also when others may read the file.
Tokens read_tokens(const std::string& path);

/// Throws std::invalid_argument when there is no such file, it is not a regular one, or every user may read or write
/// it. `what`: "the tokens".
void check_secret_file(const std::string& path, const std::string& what);

}  // namespace disparityd::base
