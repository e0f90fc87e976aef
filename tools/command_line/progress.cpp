// SPDX-License-Identifier: Apache-2.0
#include "tools/command_line/progress.h"

#include <algorithm>
#include <iostream>
#include <utility>

#include <unistd.h>

namespace disparityd::tools {

Progress::Progress(std::string what, std::optional<std::uint64_t> total)
    : what_(std::move(what)), total_(total), visible_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
    if (drawn_) {
        std::cerr << "\r\033[K" << std::flush;
    }
}

void Progress::show(std::uint64_t done, const std::string& more) {
    const auto now = std::chrono::steady_clock::now();
    if (!visible_ || now < next_) {
        return;
    }
    next_ = now + std::chrono::milliseconds(100);
    drawn_ = true;
    std::string line = what_ + ' ';
    if (total_ && *total_ > 0) {
        constexpr std::uint64_t width = 30;
        const std::uint64_t filled = std::min(done, *total_) * width / *total_;
        line += '[' + std::string(filled, '#') + std::string(width - filled, '.') + "] " + std::to_string(done) + '/' +
                std::to_string(*total_);
    } else {
        line += std::to_string(done);
    }
    std::cerr << "\r\033[K" << line << (more.empty() ? "" : "  ") << more << std::flush;
}

}  // namespace disparityd::tools
