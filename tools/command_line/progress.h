// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace disparityd::tools {

/// A line on stderr that shows how far the work is; nothing where stderr is no terminal. One thread uses it.
class Progress {
public:
    /// `total` empty: how much there is to do is not known, only what was done is shown.
    Progress(std::string what, std::optional<std::uint64_t> total);
    ~Progress();  ///< takes the line away
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Shows at most ten times a second; `more` is text for the end of the line.
    void show(std::uint64_t done, const std::string& more = {});

private:
    std::string what_;
    std::optional<std::uint64_t> total_;
    std::chrono::steady_clock::time_point next_{};
    bool visible_;
    bool drawn_ = false;
};

}  // namespace disparityd::tools
