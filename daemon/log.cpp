// SPDX-License-Identifier: Apache-2.0
#include "daemon/log.h"

#include <cstdlib>
#include <exception>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "base/failure_text.h"
#include "base/message_text.h"

namespace disparityd::daemon {
namespace {

/// Writes the priority that the journal reads from the start of a line.
class PriorityFlag final : public spdlog::custom_flag_formatter {
public:
    void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& out) override {
        char priority = '6';
        switch (message.level) {
            case spdlog::level::critical: priority = '2'; break;
            case spdlog::level::err: priority = '3'; break;
            case spdlog::level::warn: priority = '4'; break;
            case spdlog::level::debug:
            case spdlog::level::trace: priority = '7'; break;
            default: break;
        }
        out.push_back(priority);
    }
    std::unique_ptr<spdlog::custom_flag_formatter> clone() const override { return std::make_unique<PriorityFlag>(); }
};

spdlog::level::level_enum spdlog_level(LogLevel level) {
    switch (level) {
        case LogLevel::debug: return spdlog::level::debug;
        case LogLevel::info: return spdlog::level::info;
        case LogLevel::warning: return spdlog::level::warn;
        case LogLevel::error: return spdlog::level::err;
    }
    return spdlog::level::info;
}

}  // namespace

void set_up_log(const Config::Log& config) {
    const bool journal = config.target == LogTarget::journal ||
                         (config.target == LogTarget::automatic && std::getenv("JOURNAL_STREAM") != nullptr);
    std::shared_ptr<spdlog::logger> logger;
    if (journal) {
        logger = std::make_shared<spdlog::logger>("disparityd", std::make_shared<spdlog::sinks::stderr_sink_mt>());
        auto formatter = std::make_unique<spdlog::pattern_formatter>();
        formatter->add_flag<PriorityFlag>('*').set_pattern("<%*>%v");
        logger->set_formatter(std::move(formatter));
    } else {
        logger =
            std::make_shared<spdlog::logger>("disparityd", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
        logger->set_pattern("%H:%M:%S.%e %^%-7l%$ %v");
    }
    logger->set_level(spdlog_level(config.level));
    logger->flush_on(spdlog::level::debug);
    spdlog::set_default_logger(std::move(logger));
}

void set_log_level(LogLevel level) {
    spdlog::default_logger_raw()->set_level(spdlog_level(level));
}

void log_line(LogLevel level, const std::string& line) {
    // Names in the line may hold control characters.
    spdlog::default_logger_raw()->log(spdlog_level(level), base::printable_line(line));
}

void log_caught(const char* what) {
    static LogLimiter limiter(5, std::chrono::seconds(10));
    limiter.write(LogLevel::error, fmt::format("{}: {}", what, base::failure_text(std::current_exception())));
}

bool LogLimiter::allows(std::uint64_t& left_out) {
    const std::lock_guard lock(mutex_);
    if (limit_.wait().count() > 0) {
        ++left_out_;
        return false;
    }
    limit_.take();
    left_out = std::exchange(left_out_, 0);
    return true;
}

void LogLimiter::write(LogLevel level, const std::string& line) {
    std::uint64_t left_out = 0;
    if (allows(left_out)) {
        log_line(level,
                 left_out > 0 ? fmt::format("{} ({} lines of this kind left out before)", line, left_out) : line);
    }
}

}  // namespace disparityd::daemon
