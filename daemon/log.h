// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

#include "daemon/config/config.h"
#include "daemon/socket/rate_limit.h"

namespace disparityd::daemon {

/// Sets up spdlog's default logger: lines on standard error, for people, or with the priority prefix (<6>) by which the
/// journal sorts. LogTarget::automatic is the journal when $JOURNAL_STREAM is set. Called once, before other threads
/// log.
void set_up_log(const Config::Log& config);

/// Sets the level; other threads may log meanwhile.
void set_log_level(LogLevel level);

/// Writes a line of the log. Any thread. Lines are made with fmt::format: each use of the logging library's templates
/// takes seconds to compile.
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

/// Logs one line with `what` and the current exception; to be called in a catch block, any thread. The number of such
/// lines is limited.
void log_caught(const char* what);

/// Limits lines that clients can provoke: `burst` lines, then one more every `interval`. Any thread.
class LogLimiter {
public:
    explicit LogLimiter(int burst = 20, std::chrono::milliseconds interval = std::chrono::seconds(1))
        : limit_(burst, interval) {}

    /// Returns whether a line may be written now. `left_out` gets the number of lines left out since the last one.
    bool allows(std::uint64_t& left_out);

    /// Writes the line at the given level, or counts it.
    void write(LogLevel level, const std::string& line);

private:
    std::mutex mutex_;
    RateLimit limit_;
    std::uint64_t left_out_ = 0;
};

}  // namespace disparityd::daemon
