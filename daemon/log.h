// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

#include "daemon/config.h"

namespace disparityd {

/// Sets up spdlog's default logger: lines on standard error, for people, or with the priority prefix (<6>) by which the
/// journal sorts. LogTarget::automatic is the journal when $JOURNAL_STREAM is set. Called once, before other threads
/// log.
void set_up_log(const Config::Log& config);

/// What a reload may change while others log.
void set_log_level(LogLevel level);

/// A line of the log. Any thread. No template of the logging library, whose every use takes seconds to compile: lines
/// are made with fmt::format.
void log_line(LogLevel level, const std::string& line);
inline void log_info(const std::string& line) {
    log_line(LogLevel::info, line);
}
inline void log_warning(const std::string& line) {
    log_line(LogLevel::warning, line);
}
inline void log_error(const std::string& line) {
    log_line(LogLevel::error, line);
}

/// Keeps what clients can provoke from flooding the log: `burst` lines, then one more every `interval`. Any thread.
class LogLimiter {
public:
    explicit LogLimiter(int burst = 20, std::chrono::milliseconds interval = std::chrono::seconds(1))
        : burst_(burst), interval_(interval) {}

    /// Whether a line may be written now. `left_out` gets how many were not since the last that was.
    bool allows(std::uint64_t& left_out);

    /// Writes the line at the given level, or counts it.
    void write(LogLevel level, const std::string& line);

private:
    const int burst_;
    const std::chrono::nanoseconds interval_;
    std::mutex mutex_;
    int tokens_ = burst_;
    std::uint64_t left_out_ = 0;
    std::chrono::steady_clock::time_point refilled_ = std::chrono::steady_clock::now();
};

}  // namespace disparityd
